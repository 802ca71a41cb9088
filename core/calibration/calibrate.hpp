// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <chrono>
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
#include "core/virtual_cell/virtual_cell.hpp"

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

/// What one link showed, all views together.
struct LinkCoverage {
  std::string link;
  std::size_t predicted = 0;  ///< pixels predicted visible (every second one in both directions)
  double coverage = 0;        ///< share of them that the measurement agrees with, 0..1
};

/// A place of the cell where the pose is to be good, and how good it is there.
struct WorkspacePoint {
  std::string name;
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();  ///< m
};
struct WorkspaceError {
  WorkspacePoint point;
  double sigma_m = 0;  ///< standard deviation of where the pose puts the point as the sensor sees it
};

/// A direction in which the views do not hold the sensor as tightly as a pose must be held.
struct WeakDirection {
  std::string what;                                           ///< in plain words
  bool is_rotation = false;                                   ///< else a shift
  Eigen::Vector3d direction_base = Eigen::Vector3d::UnitZ();  ///< unit; of a rotation its axis
  double sigma = 0;                                           ///< rad or m
};

/// A place where the sensor might be.
struct Hypothesis {
  Pose T_base_sensor = Pose::Identity();
  double score = 0;  ///< how well it explains the view, at most 1
};

struct CalibrationSettings {
  Method method = Method::full;
  std::optional<Pose> guess_T_base_sensor;
  PaperSettings paper;      ///< of Method::paper alone
  bool depth_only = false;  ///< leave the images of the views aside
  /// For finding out why views are rejected; a busy computer gets less far in it.
  std::chrono::milliseconds explaining{6000};
  std::vector<WorkspacePoint> workspace;  ///< where the result is to tell its predicted error
  std::function<void(double)>
      on_progress;  ///< called with 0..1 from the calling thread; begins anew with a search
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
  std::vector<LinkCoverage> links;  ///< those predicted visible
  /// Median |residual| (m) of views judged by the pose that the other views give; nothing below 4 views.
  std::optional<double> held_out_residual_m;
  /// Of the start search without a guess, -1..1: how much better the best hypothesis explains the views than
  /// the next one that differs; nothing where the pose came from a guess or from a further hypothesis, or
  /// when there was only one.
  std::optional<double> runner_up_margin;
  std::vector<Hypothesis> hypotheses;  ///< of one view without a guess: where the search ended, best first
  std::vector<WeakDirection> weak_directions;  ///< worst first; empty when all are held
  std::vector<WorkspaceError> workspace;       ///< one per point asked for; empty when rejected
  int views = 0;
  bool used_guess = false;
  std::vector<Reason> reasons;
  double time_total_ms = 0;
  double time_to_pose_ms = 0;  ///< of it, until the pose was found; then it was judged
};

/// Finds T_base_sensor from one or more views. A guess from which nothing good is found is given up for a
/// search from nothing, where there are views to search in. Never throws on bad data: it returns a rejected
/// result with reasons. Needs: every view of the camera's size, joint_positions_rad of
/// RobotModel::position_count() values. Thread-safe: `cell` is only copied, and must not be moved meanwhile.
CalibrationResult calibrate(const VirtualCell& cell, const CameraModel& camera, std::span<const View> views,
                            const CalibrationSettings& settings);

/// The same with a virtual cell of its own, which costs some milliseconds to build.
CalibrationResult calibrate(const RobotModel& robot, const CameraModel& camera, std::span<const View> views,
                            const CalibrationSettings& settings);

}  // namespace calibrd
