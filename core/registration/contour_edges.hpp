// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "core/registration/normal_equations.hpp"
#include "core/registration/registration_view.hpp"

namespace calibrd {

/// Where the robot's outline is searched.
enum class EdgeSource { image, depth };

struct ContourSettings {
  EdgeSource source = EdgeSource::image;
  double search_px = 8;     ///< edges are looked for this far to both sides of the predicted contour; 0: not
  double kernel_px = 8;     ///< residuals beyond this have no weight (Tukey's biweight)
  double shift_px = 0;      ///< image edges lie this far outside the predicted contours (estimated)
  double sigma_px = 0.5;    ///< standard deviation of one edge position
  double min_contrast = 5;  ///< an edge must step this many times the image's noise
  bool fit_profile =
      false;  ///< fit the modelled light profile (unbiased) instead of the steepest step (far reach)
};

struct ContourTally {
  std::size_t predicted = 0;  ///< contour points looked at
  std::size_t found = 0;      ///< of them with an image edge within the kernel
  std::vector<float> residuals_px;
  std::vector<float> whitened;  ///< residual / sigma
  void merge(const ContourTally& other);
};

/// A place on the robot's predicted occluding contour.
struct ContourPoint {
  Eigen::Vector2d pixel;     ///< to a fraction of a pixel
  Eigen::Vector2d outward;   ///< unit normal in the image
  Eigen::Vector3d p_sensor;  ///< on the robot, just inside (m, sensor frame)
  int link = -1;
  std::size_t cluster = 0;  ///< errors of one cluster correlate
};

struct ContourSearch {
  int stride =
      2;  ///< contour pixels with (x + y) divisible by it are taken: the choice is stable between steps
  int prediction_step = 1;  ///< the prediction is that of camera.subsampled(prediction_step)
  RowBand rows;             ///< of the prediction; they begin at a multiple of kBandRows of the image
};

/// The contour that nothing hides. `prediction` must be what `view.cell` shows from `T_base_sensor`.
std::vector<ContourPoint> find_contour(const RegistrationView& view, const VirtualMeasurement& prediction,
                                       const CameraModel& camera, const Pose& T_base_sensor,
                                       const ContourSearch& search);

/// Residuals across the line of sight, which range cannot give: the robot's occluding contours are predicted
/// by the virtual sensor, and edges of the image or the depth are searched along their normals (Drummond &
/// Cipolla 2002). Needs no mask. Does nothing when the view has no image and edges of one are asked for.
/// Appends to `samples`.
void observe_contour(const RegistrationView& view, std::span<const ContourPoint> contour,
                     const CameraModel& camera, const Pose& T_base_sensor, const ContourSettings& settings,
                     std::vector<Sample>& samples, ContourTally& tally);

}  // namespace calibrd
