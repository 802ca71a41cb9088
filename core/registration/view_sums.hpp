// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <span>
#include <vector>

#include "core/registration/contour_edges.hpp"
#include "core/registration/range_residuals.hpp"

namespace calibrd {

constexpr std::array kEdgeSources{EdgeSource::image, EdgeSource::depth};

/// What one kind of edges says of a pose.
struct ContourSums {
  NormalEquations equations;
  ContourTally tally;
};

/// What views say of a pose.
struct ViewSums {
  NormalEquations range;
  RangeTally range_tally;
  std::array<ContourSums, kEdgeSources.size()> contour;  ///< by EdgeSource
  std::vector<RangeSample> samples;
  void merge(const ViewSums& other);
};

struct ViewSumSettings {
  RangeSettings range;
  std::array<ContourSettings, kEdgeSources.size()> contour;  ///< by EdgeSource
  int contour_stride = 0;                                    ///< see find_contour(); 0: no contours
  bool keep_samples = false;
};

/// Renders every view from `T_base_sensor` into `predictions` (one per view) and sums what it says, views in
/// parallel.
ViewSums sum_views(std::span<const RegistrationView> views, std::span<VirtualMeasurement> predictions,
                   const CameraModel& camera, const Pose& T_base_sensor, const DepthCorrection& correction,
                   const ViewSumSettings& settings);

/// Robust standard deviation of values that scatter about 0; 1 when there are none.
double robust_sigma(std::vector<float> values);

}  // namespace calibrd
