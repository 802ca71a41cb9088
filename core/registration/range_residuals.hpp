// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/registration/depth_noise.hpp"
#include "core/registration/normal_equations.hpp"
#include "core/registration/registration_view.hpp"
#include "core/sensing/depth_correction.hpp"

namespace calibrd {

struct RangeSettings {
  double kernel_m = 0.03;                ///< residuals beyond this have no weight (Tukey's biweight)
  double sigma_factor = 1;               ///< this sensor's noise over depth_sigma_m()
  double lateral_px = kUsualLateral_px;  ///< its lateral noise, see depth_sigma_m()
  double min_cos_incidence = 0.25;  ///< flatter surfaces say more about the pixel grid than about the pose
  int stride = 1;                   ///< every stride-th pixel of the prediction in both directions
  int prediction_step = 1;          ///< the prediction is that of camera.subsampled(prediction_step)
  double kept_kernels = 1;          ///< samples are kept up to so many kernels: weight may yet come to them
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

/// Point-to-plane residuals on projective pairs: the measured depth of a pixel against the depth the virtual
/// sensor sees there. A residual along the ray divided by its own sigma is the point-to-plane distance with
/// weight 1/((n·d)²σ²). `prediction` must be what `view.cell` shows from `T_base_sensor`; rows of it outside
/// of `rows`, which begin at a multiple of kBandRows of the image, are left out. Appends to `samples`.
void observe_range(const RegistrationView& view, const VirtualMeasurement& prediction,
                   const CameraModel& camera, const Pose& T_base_sensor, const DepthCorrection& correction,
                   const RangeSettings& settings, const RowBand& rows, std::vector<Sample>& samples,
                   RangeTally& tally);

/// The same, summed.
void add_range_residuals(const RegistrationView& view, const VirtualMeasurement& prediction,
                         const CameraModel& camera, const Pose& T_base_sensor,
                         const DepthCorrection& correction, const RangeSettings& settings,
                         NormalEquations& equations, RangeTally& tally);

}  // namespace calibrd
