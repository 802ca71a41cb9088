// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "core/calibration/view.hpp"
#include "core/drift/background_match.hpp"
#include "core/obstacles/obstacle_cells.hpp"
#include "core/sensing/depth_correction.hpp"
#include "core/virtual_cell/virtual_cell.hpp"

namespace calibrd {

struct ObstacleSettings {
  std::size_t least_points = 12;  ///< of the background's grid
  double tool_reach_m = 0.35;     ///< what lies wholly so near the end of the arm may be carried by it
};

/// Something the sensor sees that is neither robot nor remembered background. Base frame, m. Only the side
/// that faces the sensor is known.
struct Obstacle {
  Eigen::Vector3d centre_base = Eigen::Vector3d::Zero();  ///< mean of its points
  Eigen::AlignedBox3d box_base;
  std::size_t points = 0;         ///< of the background's grid: every 4th pixel in both directions
  double before_known_share = 0;  ///< of them, those in front of known background or of the robot
  bool near_tool = false;         ///< all of it is near the end of the arm: perhaps it is carried
  double distance_m = 0;          ///< smallest from the robot's surface; infinite without one
  int link = -1;                  ///< ... and which link that is
  Eigen::Vector3d nearest_base = Eigen::Vector3d::Zero();        ///< the obstacle's point there
  Eigen::Vector3d nearest_robot_base = Eigen::Vector3d::Zero();  ///< the robot's
};

/// Finds what else is there in frames of one sensor. This is information and no safety function. One thread
/// at a time.
class ObstacleFinder {
 public:
  /// The robot of `cell` must outlive it.
  ObstacleFinder(const VirtualCell& cell, const CameraModel& camera, const ObstacleSettings& settings = {})
      : camera_(camera), settings_(settings), robot_(cell, camera) {}

  /// Nearest to the robot first. `frame`: with the joints of its moment. `background`: as the same sensor saw
  /// it from `T_base_sensor`. What is less than 5 cm in front of the robot, or beside its outline by less
  /// than some pixels and not in front of it, is taken for robot.
  std::vector<Obstacle> find(const View& frame, const BackgroundMap& background, const Pose& T_base_sensor,
                             const DepthCorrection& correction);

 private:
  struct Frame;
  Obstacle describe(const Frame& frame, const std::vector<std::uint32_t>& cluster) const;
  void measure_distance(const Frame& frame, const std::vector<std::uint32_t>& cluster,
                        Obstacle& obstacle) const;
  bool is_near_tool(const std::vector<Eigen::Vector3d>& points_base) const;

  CameraModel camera_;
  ObstacleSettings settings_;
  RobotMask robot_;
};

}  // namespace calibrd
