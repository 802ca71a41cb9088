// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/sim/render/sensor_model.hpp"
#include "drivers/sim/scenes/random_cell.hpp"

namespace calibrd::sim {

struct CaptureOptions {
  Level level = Level::cell;
  std::size_t postures = 10;
  double min_distance_m = 1.0, max_distance_m = 2.0;  ///< from the sensor to the middle of the robot
  double max_roll_deg = 20;
  std::size_t min_robot_pixels = 6000;  ///< on average over the views
};

struct SimulatedView {
  std::vector<std::uint16_t> depth_mm;  ///< 0 = no measurement
  std::vector<std::uint16_t> infrared;
  std::vector<double> joint_positions_rad;  ///< as reported
  std::size_t robot_pixels = 0;
};

/// Where the sensor sees a point of the last link, and where the reported joints put it. Metres.
struct CheckPoint {
  Eigen::Vector3d p_sensor, p_base;
};

/// A recording with the truth about it, in memory.
struct SimulatedCapture {
  std::uint64_t seed = 0;
  Level level = Level::clean;
  std::vector<std::string> joint_names;
  std::string base_link;
  CameraParameters camera;
  std::vector<SimulatedView> views;
  // What an estimator must not know:
  Eigen::Isometry3d T_base_sensor;
  DepthErrors depth_errors;
  std::vector<double> joint_zero_rad;
  std::vector<CheckPoint> check_points;
  std::shared_ptr<const FurnishedCell> world;  ///< the cell, its sensor in place
  std::vector<Joints> postures;                ///< true, of the views
};

/// Records one random cell. The same seed, robot and options give the same recording.
/// `tables`: of the sensor's camera, made once for any number of recordings. Safe to call from several
/// threads. Errors: no_free_posture, no_view_of_robot.
Result<SimulatedCapture> simulate_capture(const Robot& robot, std::uint64_t seed,
                                          const CaptureOptions& options,
                                          const std::shared_ptr<const SensorTables>& tables);

}  // namespace calibrd::sim
