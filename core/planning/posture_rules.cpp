// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/planning/posture_rules.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/virtual_cell/surface_sampling.hpp"

namespace calibrd {
namespace {

constexpr std::size_t kSamples = 1500;

double robot_area_m2(const RobotModel& robot) {
  double area = 0;
  for (const Link& link : robot.links()) area += surface_area(link.surface);
  return area;
}

/// Smallest distance of two sets of points, or `enough_m` when it is no smaller.
float distance_below(const std::vector<Eigen::Vector3f>& a, const std::vector<Eigen::Vector3f>& b,
                     float enough_m) {
  float least = enough_m * enough_m;
  for (const auto& p : a)
    for (const auto& q : b) least = std::min(least, (p - q).squaredNorm());
  return std::sqrt(least);
}

JointLimits range_of(const Joint& joint) {
  if (joint.limits && joint.type != JointType::continuous) return *joint.limits;
  if (joint.type == JointType::prismatic) return {0, 0};
  return {-std::numbers::pi, std::numbers::pi};
}

}  // namespace

std::vector<double> random_posture(const RobotModel& robot, double limit_margin, std::mt19937_64& random) {
  std::vector<double> posture(robot.position_count(), 0.0);
  for (const Joint& joint : robot.joints()) {
    if (joint.position_index < 0) continue;
    const auto [lower, upper] = range_of(joint);
    const double margin = std::min(limit_margin, (upper - lower) / 2);
    const double share = std::uniform_real_distribution<double>(0, 1)(random);
    posture[static_cast<std::size_t>(joint.position_index)] =
        lower + margin + share * (upper - lower - 2 * margin);
  }
  return posture;
}

PostureRules::PostureRules(const RobotModel& robot, const Pose& T_base_sensor,
                           std::span<const std::vector<double>> seen_postures,
                           const PlanningSettings& settings)
    : robot_(robot),
      sensor_base_(T_base_sensor.translation().cast<float>()),
      seen_(seen_postures.begin(), seen_postures.end()),
      settings_(settings),
      spacing_m_(static_cast<float>(std::sqrt(robot_area_m2(robot) / kSamples))) {
  list_bodies();
  list_pairs();
}

void PostureRules::list_bodies() {
  std::vector<int> body_of(robot_.links().size(), 0);
  bodies_.emplace_back();
  for (std::size_t link = 0; link < robot_.links().size(); ++link) {  // parents before children
    const int joint = robot_.links()[link].parent_joint;
    if (joint < 0) continue;
    const auto j = static_cast<std::size_t>(joint);
    const int parent = body_of[static_cast<std::size_t>(robot_.joints()[j].parent_link)];
    body_of[link] = parent;
    if (robot_.drives()[j].position_index < 0) continue;
    body_of[link] = static_cast<int>(bodies_.size());
    bodies_.push_back({parent, {}});
  }
  const std::vector<double> zero(robot_.position_count(), 0.0);
  const std::vector<Pose> T_base_link = robot_.forward_kinematics(zero);
  for (const SurfaceSample& sample : sample_surface(robot_, zero, kSamples, 1)) {
    const auto link = static_cast<std::size_t>(sample.link);
    const Eigen::Vector3d p_link = T_base_link[link].inverse() * sample.point;
    bodies_[static_cast<std::size_t>(body_of[link])].points.emplace_back(sample.link, p_link.cast<float>());
  }
}

/// Neighbours touch at their joint. Others may come as near as the clearance; those that the robot was seen
/// to hold nearer (a wrist's parts) may come half as near as that.
void PostureRules::list_pairs() {
  auto shown = seen_;
  if (shown.empty()) shown.emplace_back(robot_.position_count(), 0.0);
  const float wanted_m = static_cast<float>(settings_.self_clearance_m) + spacing_m_ / 2;
  std::vector<std::vector<PlacedBody>> placed;
  for (const auto& posture : shown) placed.push_back(place(posture));
  for (std::size_t a = 0; a < bodies_.size(); ++a) {
    for (std::size_t b = a + 1; b < bodies_.size(); ++b) {
      if (bodies_[b].parent == static_cast<int>(a)) continue;
      float clearance_m = wanted_m;
      for (const auto& bodies : placed)
        clearance_m =
            std::min(clearance_m, distance_below(bodies[a].points, bodies[b].points, 2 * wanted_m) / 2);
      pairs_.push_back({a, b, clearance_m});
    }
  }
}

std::vector<PostureRules::PlacedBody> PostureRules::place(const std::vector<double>& posture) const {
  std::vector<Eigen::Isometry3f> T_base_link;
  for (const Pose& T : robot_.forward_kinematics(posture)) T_base_link.push_back(T.cast<float>());
  std::vector<PlacedBody> placed(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    placed[b].points.reserve(bodies_[b].points.size());
    for (const auto& [link, p_link] : bodies_[b].points) {
      placed[b].points.push_back(T_base_link[static_cast<std::size_t>(link)] * p_link);
      placed[b].box.extend(placed[b].points.back());
    }
  }
  return placed;
}

bool PostureRules::within_limits(const std::vector<double>& posture) const {
  for (std::size_t j = 0; j < robot_.joints().size(); ++j) {
    const Joint& joint = robot_.joints()[j];
    if (!joint.mimic || !joint.limits) continue;
    const double position = robot_.drives()[j].position(posture);
    if (position < joint.limits->lower || position > joint.limits->upper) return false;
  }
  return true;
}

bool PostureRules::differs_from_seen(const std::vector<double>& posture) const {
  return std::ranges::all_of(seen_, [&](const std::vector<double>& seen) {
    double most = 0;
    for (std::size_t j = 0; j < seen.size(); ++j) most = std::max(most, std::abs(seen[j] - posture[j]));
    return most >= settings_.min_change_rad;
  });
}

const char* PostureRules::space_objection(const std::vector<PlacedBody>& bodies) const {
  const float margin_m = spacing_m_ / 2;  // what lies between the sampled points
  const auto least_range_m = static_cast<float>(settings_.min_range_m);
  for (std::size_t b = 1; b < bodies.size(); ++b) {  // 0 never moves
    if (bodies[b].points.empty()) continue;
    if (bodies[b].box.min().z() - margin_m < static_cast<float>(settings_.min_height_m))
      return "a link would be below the table";
    if (settings_.workspace_base && !settings_.workspace_base->cast<float>().contains(bodies[b].box))
      return "a link would leave the workspace";
    if (bodies[b].box.exteriorDistance(sensor_base_) > least_range_m) continue;
    for (const auto& point : bodies[b].points)
      if ((point - sensor_base_).norm() < least_range_m) return "a link would come too near to the sensor";
  }
  return nullptr;
}

bool PostureRules::apart(const std::vector<PlacedBody>& bodies) const {
  return std::ranges::all_of(pairs_, [&](const Pair& pair) {
    const PlacedBody &a = bodies[pair.a], &b = bodies[pair.b];
    if (a.points.empty() || b.points.empty()) return true;
    if (a.box.exteriorDistance(b.box) >= pair.clearance_m) return true;
    return distance_below(a.points, b.points, pair.clearance_m) >= pair.clearance_m;
  });
}

const char* PostureRules::objection(const std::vector<double>& posture) const {
  if (!differs_from_seen(posture)) return "it is too like a posture seen";
  if (!within_limits(posture)) return "a joint that follows others would be beyond its limits";
  const auto bodies = place(posture);
  if (const char* against = space_objection(bodies)) return against;
  return apart(bodies) ? nullptr : "two links would come too near to each other";
}

}  // namespace calibrd
