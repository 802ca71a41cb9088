// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/planning/next_posture.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/planning/expected_views.hpp"
#include "core/planning/posture_rules.hpp"

namespace calibrd {
namespace {

struct Choice {
  std::vector<double> posture;
  ExpectedViews::Expectation expectation;
};

std::optional<Choice> best_choice(const PostureRules& rules, ExpectedViews& views, const RobotModel& robot,
                                  const PlanningSettings& settings) {
  std::mt19937_64 random(settings.seed);
  std::optional<Choice> best;
  std::size_t looked_at = 0;
  for (std::size_t drawn = 0; drawn < settings.draws && looked_at < settings.candidates; ++drawn) {
    auto posture = random_posture(robot, settings.limit_margin, random);
    if (!rules.allow(posture)) continue;
    ++looked_at;
    const auto expectation = views.after(posture);
    if (!expectation) continue;
    if (!best || expectation->covariance.trace() < best->expectation.covariance.trace())
      best = Choice{std::move(posture), *expectation};
  }
  return best;
}

/// The sensor's axis that a direction (base frame) lies closest to.
std::size_t nearest_axis(const Eigen::Vector3d& direction_base, const Pose& T_base_sensor) {
  const Eigen::Vector3d direction_sensor = T_base_sensor.linear().transpose() * direction_base;
  Eigen::Index axis = 0;
  direction_sensor.cwiseAbs().maxCoeff(&axis);
  return static_cast<std::size_t>(axis);
}

/// "position across the view, left-right: 1.90 mm -> 0.80 mm", of the weakest direction.
std::string weakest_direction(const Matrix6d& now, const Matrix6d& expected, const Pose& T_base_sensor) {
  constexpr std::array kPositions{"position left-right", "position up-down", "position along the view"};
  constexpr std::array kRotations{"tilt", "pan", "roll about the view"};
  const bool is_position = now.bottomRightCorner<3, 3>().trace() >= now.topLeftCorner<3, 3>().trace();
  const int block = is_position ? 3 : 0;
  const Eigen::Matrix3d before = now.block<3, 3>(block, block);
  const Eigen::Vector3d weakest =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(before).eigenvectors().col(2);
  const std::size_t axis = nearest_axis(weakest, T_base_sensor);
  const auto milli = [&](const Matrix6d& covariance) {
    return 1e3 * std::sqrt(weakest.dot(covariance.block<3, 3>(block, block) * weakest));
  };
  const char* unit = is_position ? "mm" : "mrad";
  char text[160];
  std::snprintf(text, sizeof text, "%s, seen from the sensor: from %.2f %s to %.2f %s (1 sigma)",
                is_position ? kPositions[axis] : kRotations[axis], milli(now), unit, milli(expected), unit);
  return text;
}

}  // namespace

std::optional<PostureSuggestion> suggest_posture(const VirtualCell& cell, const CameraModel& camera,
                                                 const Pose& T_base_sensor, const Matrix6d& covariance,
                                                 std::span<const std::vector<double>> seen_postures,
                                                 const PlanningSettings& settings) {
  const RobotModel& robot = cell.robot();
  const PostureRules rules(robot, T_base_sensor, seen_postures, settings);
  ExpectedViews views(cell, camera, T_base_sensor, covariance, seen_postures, settings);
  const auto best = best_choice(rules, views, robot, settings);
  if (!best) return std::nullopt;
  const Matrix6d& expected = best->expectation.covariance;
  PostureSuggestion suggestion;
  suggestion.joint_names = robot.position_names();
  suggestion.positions_rad = best->posture;
  suggestion.sigma_rotation_rad = std::sqrt(expected.topLeftCorner<3, 3>().trace());
  suggestion.sigma_position_m = std::sqrt(expected.bottomRightCorner<3, 3>().trace());
  suggestion.robot_pixels = best->expectation.robot_pixels;
  suggestion.improves = weakest_direction(covariance, expected, T_base_sensor);
  return suggestion;
}

}  // namespace calibrd
