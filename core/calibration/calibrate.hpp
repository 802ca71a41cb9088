// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/calibration/view.hpp"
#include "core/geometry/camera_model.hpp"
#include "core/geometry/pose.hpp"
#include "core/paper/paper_settings.hpp"
#include "core/robot/robot_model.hpp"
#include "core/sensing/depth_correction.hpp"

namespace calibrd {

enum class Method { full, paper };
enum class Verdict { accepted, uncertain, rejected };

/// Why a verdict is what it is: a stable code for programs, a sentence for people.
struct Reason {
  std::string code;
  std::string text;
};

/// Where a joint truly is when its reported position is 0, as far as the views tell (rad, prismatic: m).
struct JointZero {
  std::string joint;
  double zero = 0;   ///< true minus reported position
  double sigma = 0;  ///< its standard deviation; close to the prior where the views do not show it
};

struct CalibrationSettings {
  Method method = Method::full;
  std::optional<Pose> guess_T_base_sensor;
  PaperSettings paper;                      ///< of Method::paper alone
  bool depth_only = false;                  ///< leave the images of the views aside
  std::function<void(double)> on_progress;  ///< called with 0..1 from the calling thread
  const std::atomic<bool>* cancelled =
      nullptr;  ///< polled; when true, calibrate returns early as rejected/"cancelled"
};

/// How one calibration went. A rejected one carries no pose; an uncertain one carries its best.
struct CalibrationResult {
  Verdict verdict = Verdict::rejected;
  std::optional<Pose> T_base_sensor;
  /// Covariance of (δω rad, δt m), see perturbed(): about the sensor origin, base axes.
  /// A metre and a radian in every direction until something is known: 0 would claim certainty.
  Matrix6d covariance = Matrix6d::Identity();
  double sigma_position_m = std::sqrt(3.0);    ///< sqrt of the trace of the translation block
  double sigma_rotation_rad = std::sqrt(3.0);  ///< sqrt of the trace of the rotation block
  DepthCorrection depth_correction;
  std::vector<JointZero> joint_zeros;  ///< reported beside the pose, not hidden in it
  double residual_rms_m = 0;
  double coverage =
      0;  ///< share of the robot pixels predicted visible that the measurement agrees with, 0..1
  int views = 0;
  bool used_guess = false;
  std::vector<Reason> reasons;
  double time_total_ms = 0;
};

/// Finds T_base_sensor from one or more views. Never throws on bad data: it returns a rejected result with
/// reasons. Needs: every view of the camera's size, joint_positions_rad of RobotModel::position_count()
/// values. Thread-safe: concurrent calls share nothing.
CalibrationResult calibrate(const RobotModel& robot, const CameraModel& camera, std::span<const View> views,
                            const CalibrationSettings& settings);

}  // namespace calibrd
