// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "core/calibration/view.hpp"
#include "core/geometry/camera_model.hpp"
#include "core/geometry/pose.hpp"
#include "core/robot/robot_model.hpp"
#include "core/virtual_cell/virtual_cell.hpp"

namespace calibrd::test {

/// An arm of six joints made of boxes and cylinders, about as large as a SIA5F.
const RobotModel& test_arm();

/// A workbench, boxes on it, a post and a wall; base frame as the arm's.
const RobotModel& test_clutter();

/// A Kinect v2 with a perfect lens, and with its own.
CameraModel ideal_kinect2();
CameraModel kinect2();

/// 1.5 m from the arm's middle, looking at it slightly from above.
Pose true_T_base_sensor();

/// Six postures that show the arm from different sides.
std::vector<std::vector<double>> postures(std::size_t count);

/// What the simulated sensor does to the truth.
struct SceneSettings {
  CameraModel camera = ideal_kinect2();
  double noise = 1;  ///< times a time-of-flight sensor's axial noise (about 1.4 mm head on); white
  double offset_m = 0;
  double scale = 1;
  bool clutter = false;
  bool second_arm = false;  ///< another arm of the same make beside ours, which does not follow the joints
  bool images = false;
  double hidden_share = 0;  ///< this share of the picture, from its left, is covered by something 0.6 m ahead
  std::uint64_t seed = 1;
};

/// A view of the arm at `joints`, from `T_base_sensor`.
View render_view(const std::vector<double>& joints, const Pose& T_base_sensor, const SceneSettings& settings);

/// Views of the first `count` postures from true_T_base_sensor().
std::vector<View> render_views(std::size_t count, const SceneSettings& settings = {});

/// A pose off by exactly that much: turned about the point 1.3 m ahead of the sensor about a random axis,
/// shifted in a random direction.
Pose off_by(const Pose& T_base_sensor, double offset_m, double angle_rad, std::uint64_t seed);

}  // namespace calibrd::test
