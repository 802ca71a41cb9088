// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/planning/posture_way.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/planning/posture_rules.hpp"

namespace calibrd {
namespace {

constexpr double kDegPerRad = 180 / std::numbers::pi;

/// Rules without a sensor, and that do not mind a posture seen before.
PostureRules rules_of(const RobotModel& robot, const std::vector<double>& from, const WaySettings& settings) {
  PlanningSettings planning;
  planning.min_height_m = settings.min_height_m;
  planning.self_clearance_m = settings.self_clearance_m;
  planning.min_change_rad = 0;
  planning.min_range_m = 0;
  const Pose nowhere_near(Eigen::Translation3d(1e3, 0, 0));
  return {robot, nowhere_near, std::span(&from, 1), planning};
}

std::optional<std::string> limit_objection(const RobotModel& robot, const std::vector<double>& posture) {
  if (posture.size() != robot.position_count())
    return "it has " + std::to_string(posture.size()) + " joints, the robot has " +
           std::to_string(robot.position_count());
  for (const Joint& joint : robot.joints()) {
    if (joint.position_index < 0 || !joint.limits) continue;
    const double position = posture[static_cast<std::size_t>(joint.position_index)];
    if (position >= joint.limits->lower && position <= joint.limits->upper) continue;  // NaN is outside
    char text[96];
    std::snprintf(text, sizeof text, " at %.2f deg is beyond its limits %.2f to %.2f deg",
                  position * kDegPerRad, joint.limits->lower * kDegPerRad, joint.limits->upper * kDegPerRad);
    return joint.name + text;
  }
  return std::nullopt;
}

std::optional<std::string> step_objection(const PostureRules& rules, const std::vector<double>& from,
                                          const std::vector<double>& to, double step_rad) {
  double longest = 0;
  for (std::size_t j = 0; j < from.size(); ++j) longest = std::max(longest, std::abs(to[j] - from[j]));
  const int steps = std::max(1, static_cast<int>(std::ceil(longest / step_rad)));
  auto posture = from;
  for (int i = 0; i <= steps; ++i) {
    for (std::size_t j = 0; j < from.size(); ++j)
      posture[j] = i == steps ? to[j] : from[j] + (to[j] - from[j]) * i / steps;
    if (const char* against = rules.objection(posture))
      return i == steps ? std::string(against)
                        : "after " + std::to_string(100 * i / steps) + " % of the way there " + against;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> way_objection(const RobotModel& robot, const std::vector<double>& from,
                                         std::span<const std::vector<double>> postures,
                                         const WaySettings& settings) {
  const auto named = [](std::size_t i, const std::string& against) {
    return "posture " + std::to_string(i + 1) + ": " + against;
  };
  if (auto against = limit_objection(robot, from)) return "where the robot is: " + *against;
  for (std::size_t i = 0; i < postures.size(); ++i)
    if (const auto against = limit_objection(robot, postures[i])) return named(i, *against);
  const PostureRules rules = rules_of(robot, from, settings);
  for (std::size_t i = 0; i < postures.size(); ++i) {
    const auto& start = i == 0 ? from : postures[i - 1];
    if (const auto against = step_objection(rules, start, postures[i], settings.step_rad))
      return named(i, *against);
  }
  return std::nullopt;
}

}  // namespace calibrd
