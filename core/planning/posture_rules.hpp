// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <random>
#include <span>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/planning/planning_settings.hpp"
#include "core/robot/robot_model.hpp"

namespace calibrd {

/// A random posture within the joints' limits; mimic joints are left to PostureRules. A joint without limits
/// turns by ±180°; a prismatic one without stays at 0. Positions: RobotModel::position_names() order.
std::vector<double> random_posture(const RobotModel& robot, double limit_margin, std::mt19937_64& random);

/// Which postures the robot may be sent to, as far as its model alone can tell: from points sampled on its
/// surface, without rendering. Obstacles and the way there are not known. `robot` must outlive it.
class PostureRules {
 public:
  PostureRules(const RobotModel& robot, const Pose& T_base_sensor,
               std::span<const std::vector<double>> seen_postures, const PlanningSettings& settings);

  bool allow(const std::vector<double>& posture) const { return objection(posture) == nullptr; }

  /// What speaks against it, in words ("a link would be below the table"); null: nothing.
  const char* objection(const std::vector<double>& posture) const;

 private:
  /// Links that fixed joints hold together.
  struct Body {
    int parent = -1;                                      // body; -1: the one that never moves
    std::vector<std::pair<int, Eigen::Vector3f>> points;  // link, and the point in its frame
  };
  struct PlacedBody {
    std::vector<Eigen::Vector3f> points;  // base frame
    Eigen::AlignedBox3f box;
  };
  struct Pair {
    std::size_t a, b;
    float clearance_m;
  };

  void list_bodies();
  void list_pairs();
  std::vector<PlacedBody> place(const std::vector<double>& posture) const;
  bool within_limits(const std::vector<double>& posture) const;
  bool differs_from_seen(const std::vector<double>& posture) const;
  const char* space_objection(const std::vector<PlacedBody>& bodies) const;
  bool apart(const std::vector<PlacedBody>& bodies) const;

  const RobotModel& robot_;
  const Eigen::Vector3f sensor_base_;
  const std::vector<std::vector<double>> seen_;
  const PlanningSettings settings_;
  float spacing_m_ = 0;  // of the sampled points
  std::vector<Body> bodies_;
  std::vector<Pair> pairs_;
};

}  // namespace calibrd
