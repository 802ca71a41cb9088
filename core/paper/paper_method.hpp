// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.hpp"
#include "core/calibration/view.hpp"
#include "core/geometry/camera_model.hpp"
#include "core/geometry/pose.hpp"
#include "core/paper/paper_settings.hpp"
#include "core/robot/robot_model.hpp"

namespace calibrd {

struct PaperFit {
  Pose T_base_sensor = Pose::Identity();
  bool converged = false;  ///< in ICP's sense: nothing changes any more, which says nothing about truth
  double rms_m = 0;        ///< root mean squared distance of correspondences
  std::size_t measured_points = 0, model_points = 0;  ///< after down-sampling
};

/// "Automatic Calibration of Industrial Robot and 3D Sensors using Real-Time Simulator", section IV: CAD
/// sampling, region of interest, down-sampling, point-to-point ICP by SVD, the last two by PCL. Its equations
/// mix directions; used here is what follows from p_virtual = R p_real + t: T_base_real = T_base_virtual *
/// T_virtual_real, with the virtual sensor at the guess. One posture. Errors: PaperError.
Result<PaperFit> fit_by_paper(const RobotModel& robot, const CameraModel& camera, const View& view,
                              const Pose& guess_T_base_sensor, const PaperSettings& settings);

}  // namespace calibrd
