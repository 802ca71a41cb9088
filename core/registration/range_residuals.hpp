// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/registration/normal_equations.hpp"
#include "core/registration/registration_view.hpp"
#include "core/sensing/depth_correction.hpp"

namespace calibrd {

struct RangeSettings {
  double kernel_m = 0.03;           ///< residuals beyond this have no weight (Tukey's biweight)
  double sigma_factor = 1;          ///< this sensor's noise over depth_sigma_m()
  double min_cos_incidence = 0.25;  ///< flatter surfaces say more about the pixel grid than about the pose
  int stride = 1;                   ///< every stride-th pixel in both directions
};

/// What the pixels of one view say about its prediction.
struct RangeTally {
  std::size_t predicted = 0;     ///< robot pixels looked at
  std::size_t measured = 0;      ///< of them with a usable measurement
  std::size_t agreeing = 0;      ///< of them within the kernel
  std::size_t occluded = 0;      ///< something stands in front of the robot
  std::size_t seen_through = 0;  ///< measured behind the robot: free-space violation
  std::vector<float> whitened;   ///< residual / sigma of the agreeing ones
  void merge(const RangeTally& other);
};

/// A range observation together with the depth it was made at, for choosing the period of the periodic term.
struct RangeSample {
  Observation observation;
  double depth_m = 0;
};

/// Point-to-plane residuals on projective pairs: the measured depth of a pixel against the depth the virtual
/// sensor sees there. A residual along the ray divided by its own sigma is the point-to-plane distance with
/// weight 1/((n·d)²σ²). `prediction` must be what `view.cell` shows from `T_base_sensor`. The observations
/// are also appended to `samples` when it is given.
void add_range_residuals(const RegistrationView& view, const VirtualMeasurement& prediction,
                         const CameraModel& camera, const Pose& T_base_sensor,
                         const DepthCorrection& correction, const RangeSettings& settings,
                         NormalEquations& equations, RangeTally& tally,
                         std::vector<RangeSample>* samples = nullptr);

}  // namespace calibrd
