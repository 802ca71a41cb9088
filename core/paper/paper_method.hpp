// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "core/calibration/view.hpp"
#include "core/geometry/camera_model.hpp"
#include "core/robot/robot_model.hpp"

namespace calibrd {

/// The published method's choices. Its own thresholds are not stated; these are documented in
/// docs/results.md.
struct PaperSettings {
  std::size_t model_points = 40000;  ///< uniform samples of the CAD surface (section IV.B)
  double voxel_m = 0.01;             ///< down-sampling of both clouds
  double region_margin_m = 0.1;      ///< region of interest: the robot's bounding box at the guess, widened
  double max_correspondence_m = 0.1;
  int max_iterations = 200;
  double transformation_epsilon = 1e-9;  ///< PCL: squared change of the transform that ends the iteration
  std::uint64_t seed = 1;
};

struct PaperFit {
  Pose T_base_sensor = Pose::Identity();
  bool converged = false;  ///< in ICP's sense: nothing changes any more, which says nothing about truth
  double rms_m = 0;        ///< root mean squared distance of correspondences
  std::size_t points = 0;  ///< measured points used
};

/// "Automatic Calibration of Industrial Robot and 3D Sensors using Real-Time Simulator": uniform CAD
/// sampling, region of interest, down-sampling, point-to-point ICP by SVD. Its equations mix directions; used
/// here is what follows from p_virtual = R p_real + t: T_base_real = T_base_virtual * T_virtual_real, both
/// clouds centred on their matched pairs in every iteration. One posture. Nothing when the
/// region holds no measured points.
std::optional<PaperFit> fit_by_paper(const RobotModel& robot, const CameraModel& camera, const View& view,
                                     const Pose& guess_T_base_sensor, const PaperSettings& settings);

}  // namespace calibrd
