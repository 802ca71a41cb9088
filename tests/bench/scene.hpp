// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/calibration/view.hpp"
#include "core/geometry/camera_model.hpp"
#include "core/geometry/pose.hpp"
#include "core/robot/robot_model.hpp"
#include "drivers/sim/scenes/simulate_capture.hpp"
#include "drivers/sim/world/robot.hpp"
#include "tests/bench/bench.hpp"

namespace calibrd::bench {

/// One robot, read by the simulator and by core: neither sees the other's.
struct SceneRobot {
  std::string name;
  sim::Robot simulated;
  RobotModel model;
};

/// Errors: as read_robot() and RobotModel::load().
Result<SceneRobot> read_scene_robot(const std::filesystem::path& urdf, const Paths& models);
Result<std::vector<SceneRobot>> read_scene_robots(const RandomScenes& scenes);

/// What an estimator has in the field, and apart from it the truth that it is judged by.
struct Scene {
  const SceneRobot* robot = nullptr;
  CameraModel camera;  ///< nominal
  std::vector<View> views;
  sim::SimulatedCapture truth;  ///< its views are moved out
  std::vector<std::size_t> robot_pixels;
  std::vector<double> joint_zeros_rad;  ///< true minus reported, order of the model

  /// Joint positions as they truly were, order of the model.
  std::vector<double> true_joints_rad(std::size_t view) const;
};

/// One random scene, in memory. `robot` must outlive it. Errors: as simulate_capture().
Result<Scene> simulate_scene(const SceneRobot& robot, std::uint64_t seed, const sim::CaptureOptions& options,
                             const std::shared_ptr<const sim::SensorTables>& tables);

/// The pose that is right for the joints as reported over the first `views` views: it puts the robot's
/// visible tip best where these joints say it is (other links count 1/50, as calibrate() states it). The true
/// pose where no joint zero is off.
Pose pose_for_reported_joints(const Scene& scene, std::size_t views);

/// Root mean square distance (m) over the check points of all views: where the pose puts what the sensor
/// sees of the last link against where the reported joints put it.
double check_point_rms_m(const Scene& scene, const Pose& T_base_sensor);

}  // namespace calibrd::bench
