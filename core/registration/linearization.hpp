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

/// What one kind of edges says of the parameters.
struct ContourSums {
  NormalEquations equations;
  ContourTally tally;
};

/// What views say of the parameters.
struct ViewSums {
  NormalEquations range;
  RangeTally range_tally;
  std::array<ContourSums, kEdgeSources.size()> contour;  ///< by EdgeSource
  void merge(const ViewSums& other);
};

struct LinearizationSettings {
  RangeSettings range;
  std::array<ContourSettings, kEdgeSources.size()> contour;  ///< by EdgeSource
  int stride = 1;          ///< every stride-th pixel in both directions is rendered and looked at
  int contour_stride = 0;  ///< see ContourSearch; 0: no contours
};

/// What the views say about the parameters around one point: rendered and measured once, then good for every
/// step that is small against what the kernels reach.
class Linearization {
 public:
  /// Renders every view from `T_base_sensor` into `predictions` (one per view) and observes it. Forgets what
  /// was there before, but keeps its memory.
  void observe(std::span<const RegistrationView> views, std::span<VirtualMeasurement> predictions,
               const CameraModel& camera, const Pose& T_base_sensor, const DepthCorrection& correction,
               const LinearizationSettings& settings);

  /// The sums where the parameters have moved by `delta`; robust weights are those of the residuals there.
  ViewSums sums(const ParameterVector& delta) const;

  std::size_t range_count() const;
  double nearest_m() const;  ///< depth of the nearest range sample; 1 when there is none
  /// Evenly thinned to about `most`.
  std::vector<Sample> range_samples(std::size_t most) const;

 private:
  /// Of one view; bands are worked on in parallel.
  struct Band {
    std::vector<Sample> range;
    std::array<std::vector<Sample>, kEdgeSources.size()> contour;  // by EdgeSource
    RangeTally range_tally;
    std::array<ContourTally, kEdgeSources.size()> contour_tally;
    void clear();
  };
  ViewSums sums_of(const Band& band, const ParameterVector& delta) const;

  LinearizationSettings settings_;
  std::vector<Band> bands_;
};

/// Robust standard deviation of values that scatter about 0; 1 when there are none.
double robust_sigma(std::vector<float> values);

}  // namespace calibrd
