// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/registration/normal_equations.hpp"
#include "core/registration/registration_view.hpp"

namespace calibrd {

/// Where the robot's outline is searched.
enum class EdgeSource { image, depth };

struct ContourSettings {
  EdgeSource source = EdgeSource::image;
  double search_px = 8;     ///< image edges are looked for this far to both sides of the predicted contour
  double kernel_px = 8;     ///< residuals beyond this have no weight (Tukey's biweight)
  double shift_px = 0;      ///< image edges lie this far outside the predicted contours (estimated)
  double sigma_px = 0.5;    ///< standard deviation of one edge position
  double min_contrast = 5;  ///< an edge must step this many times the image's noise
  bool fit_profile =
      false;       ///< fit the modelled light profile (unbiased) instead of the steepest step (far reach)
  int stride = 2;  ///< contour pixels with (x + y) divisible by it: the choice is stable between steps
};

struct ContourTally {
  std::size_t predicted = 0;  ///< contour points looked at
  std::size_t found = 0;      ///< of them with an image edge within the kernel
  std::vector<float> residuals_px;
  std::vector<float> whitened;  ///< residual / sigma
  void merge(const ContourTally& other);
};

/// Residuals across the line of sight, which range cannot give: the robot's occluding contours are predicted
/// by the virtual sensor, and edges of the image or the depth are searched along their normals (Drummond &
/// Cipolla 2002). Needs no mask. `prediction` must be what `view.cell` shows from `T_base_sensor`. Does
/// nothing when the view has no image and edges of one are asked for.
void add_contour_residuals(const RegistrationView& view, const VirtualMeasurement& prediction,
                           const CameraModel& camera, const Pose& T_base_sensor,
                           const ContourSettings& settings, NormalEquations& equations, ContourTally& tally);

}  // namespace calibrd
