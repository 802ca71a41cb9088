// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/running_cell.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace calibrd::bench {
namespace {

constexpr double kWorkSpeed_rad_s = 0.5, kHold_s = 1.0;
constexpr double kStillSpeed_rad_s = 0.002;
constexpr double kBiasRamp_s = 2;
constexpr double kFloor_m = -0.8;
/// What nobody could see, hidden or out of view, is no event.
constexpr float kSeenChange_m = 0.04F;
constexpr std::size_t kSeenPixels = 800;
constexpr double kMostTurn_rad = 0.05, kMostShift_m = 0.03, kLeastMove = 0.003;

std::string said(const char* format, double a, double b = 0) {
  char text[80];
  std::snprintf(text, sizeof(text), format, a, b);
  return text;
}

}  // namespace

const char* right_verdict(Event event) {
  switch (event) {
    case Event::nothing:
      return "in_place";
    case Event::sensor_moved:
      return "sensor_moved";
    case Event::something_in_front:
      return "something_in_front";
    case Event::scene_changed:
      return "scene_changed";
    case Event::robot_model_wrong:
      return "robot_model_wrong";
    case Event::depth_bias_changed:
      return "depth_bias_changed";
    case Event::dark:
      break;
  }
  return "no_evidence";
}

RunningCell::RunningCell(const Scene& scene, std::shared_ptr<const sim::SensorTables> tables,
                         std::uint64_t seed)
    : scene_(scene),
      state_(scene.truth.world->state),
      random_(seed ^ 0xd21f7ULL),
      cell_(scene.truth.world->cell),
      company_(cell_, random_),
      model_(cell_, std::move(tables)),
      T_base_sensor_(scene.truth.T_base_sensor),
      seed_(seed),
      depth_mm_(static_cast<std::size_t>(scene.camera.width) *
                static_cast<std::size_t>(scene.camera.height)) {
  for (const auto& name : scene.robot->model.position_names())
    order_.push_back(static_cast<std::size_t>(std::ranges::find(scene.truth.joint_names, name) -
                                              scene.truth.joint_names.begin()));
  state_.sensors[0].infrared.texture = 0;  // nobody looks at the image
  state_.motion.place(scene.truth.postures.front(), 0);
  state_.motion.visit(scene.truth.postures, sim::Profile::minimum_jerk, kWorkSpeed_rad_s, kHold_s, 0);
}

RunningCell::Frame RunningCell::next() {
  now_ns_ += static_cast<std::int64_t>(1e9 / kRate_hz);
  auto& sensor = state_.sensors[0];
  if (bias_since_s_ >= 0)
    sensor.depth.offset_m =
        std::lerp(bias_from_m_, bias_to_m_, std::min(1.0, (time_s() - bias_since_s_) / kBiasRamp_s));
  sensor.T_base_sensor = sim::PoseValues::of(T_base_sensor_);
  company_.move(state_.motion.positions_at(now_ns_), now_ns_);
  model_.expose(state_, sensor, now_ns_, seed_ * 1'000'003 + ++frame_, depth_mm_, {});
  Frame frame;
  frame.view.depth = {scene_.camera.width, scene_.camera.height, 0.001, depth_mm_};
  frame.view.stamp_s = time_s();
  const auto reported = state_.reported_at(now_ns_);
  const auto speeds = state_.motion.velocities_at(now_ns_);
  frame.still = true;
  for (const std::size_t j : order_) {
    frame.view.joint_positions_rad.push_back(reported[j]);
    frame.still = frame.still && std::abs(speeds[j]) < kStillSpeed_rad_s;
  }
  return frame;
}

Eigen::Vector3d RunningCell::random_direction() {
  return Eigen::Vector3d(random_.normal(), random_.normal(), random_.normal()).normalized();
}

double RunningCell::moved_m() const {
  return (T_base_sensor_.translation() - scene_.truth.T_base_sensor.translation()).norm();
}

double RunningCell::turned_rad() const {
  return log_so3(T_base_sensor_.linear() * scene_.truth.T_base_sensor.linear().transpose()).norm();
}

void RunningCell::move_sensor(double shift_m, double turn_rad) {
  T_base_sensor_.linear() = Eigen::AngleAxisd(turn_rad, random_direction()) * T_base_sensor_.linear();
  T_base_sensor_.translation() += shift_m * random_direction();
}

sim::PersonState RunningCell::walk_across(double part) {
  const Eigen::Vector3d sensor = T_base_sensor_.translation();
  const Eigen::Vector2d sight = -sensor.head<2>().normalized(), across(-sight.y(), sight.x());
  const double side = random_.chance(0.5) ? 1 : -1;
  const Eigen::Vector2d middle = (1 - part) * sensor.head<2>();
  const Eigen::Vector2d from = middle + side * 2.2 * across + random_.uniform(-0.3, 0.3) * sight,
                        to = middle - side * 2.2 * across + random_.uniform(-0.3, 0.3) * sight;
  return {1, now_ns_, {from.x(), from.y()}, {to.x(), to.y()}, kFloor_m, random_.uniform(0.6, 1.4)};
}

void RunningCell::send_people() {
  send_people_away();
  state_.person = walk_across(random_.uniform(0.25, 0.7));
  const std::uint64_t more = random_.bits() % Company::kPeople;
  for (std::size_t i = 0; i < more; ++i) company_.send(i, walk_across(random_.uniform(0.25, 1.6)));
}

std::string RunningCell::change_object(std::size_t chosen) {
  const std::string& name = scene_.truth.world->cell.objects[chosen].name;
  auto& object = state_.objects[chosen];
  if (object.present == 0) {
    object.present = 1;
    return name + " brought";
  }
  if (random_.chance(0.5)) {
    object.present = 0;
    return name + " taken away";
  }
  auto pose = object.T_base_object.pose();
  const double angle = random_.uniform(-std::numbers::pi, std::numbers::pi), way = random_.uniform(0.08, 0.3);
  pose.translation() += Eigen::Vector3d(way * std::cos(angle), way * std::sin(angle), 0);
  object.T_base_object = sim::PoseValues::of(pose);
  return name + said(" moved by %.0f mm", 1e3 * way);
}

std::vector<float> RunningCell::true_depth_m() {
  model_.expose(state_, state_.sensors[0], now_ns_, 0, depth_mm_, {});
  return {model_.truth().depth_m.begin(), model_.truth().depth_m.end()};
}

std::string RunningCell::change_scene() {
  const auto& objects = scene_.truth.world->cell.objects;
  std::vector<std::size_t> things;
  for (std::size_t i = 0; i < objects.size(); ++i)
    if (objects[i].name == "box" || objects[i].name == "post") things.push_back(i);
  const auto before = true_depth_m();
  for (int tries = 0; tries < 20 && !things.empty(); ++tries) {
    const auto objects_before = state_.objects;
    const std::string what = change_object(things[random_.bits() % things.size()]);
    const auto after = true_depth_m();
    std::size_t changed = 0;
    for (std::size_t i = 0; i < after.size(); ++i) changed += std::abs(after[i] - before[i]) > kSeenChange_m;
    if (changed >= kSeenPixels) return what + said(" (%.0f px)", static_cast<double>(changed));
    state_.objects = objects_before;
  }
  return {};
}

std::string RunningCell::stage(Event event) {
  switch (event) {
    case Event::nothing:
      return "nothing";
    case Event::sensor_moved: {
      // Half of them just above what must be found.
      const double most = random_.chance(0.5) ? 2 * kLeastMove : kMostShift_m;
      const bool shifts = random_.chance(0.5);
      const double shift_m = shifts ? random_.uniform(kLeastMove, most) : random_.uniform(0, most);
      const double turn_rad =
          shifts ? random_.uniform(0, most * kMostTurn_rad / kMostShift_m)
                 : random_.uniform(kLeastMove, std::max(most, kMostTurn_rad * (most / kMostShift_m)));
      move_sensor(shift_m, turn_rad);
      return said("sensor by %.1f mm, %.1f mrad", 1e3 * shift_m, 1e3 * turn_rad);
    }
    case Event::something_in_front:
      send_people();
      return "people";
    case Event::scene_changed:
      return change_scene();
    case Event::robot_model_wrong: {
      const std::size_t joint = random_.bits() % 3;
      const double zero = random_.uniform(0.01, 0.03) * (random_.chance(0.5) ? 1 : -1);
      state_.joint_zero_rad[order_[joint]] += zero;
      return said("joint %.0f by %.1f mrad", static_cast<double>(joint + 1), 1e3 * zero);
    }
    case Event::depth_bias_changed:
      bias_since_s_ = time_s();
      bias_from_m_ = state_.sensors[0].depth.offset_m;
      bias_to_m_ = bias_from_m_ + random_.uniform(0.005, 0.015) * (random_.chance(0.5) ? 1 : -1);
      return said("range by %.1f mm", 1e3 * (bias_to_m_ - bias_from_m_));
    case Event::dark:
      state_.sensors[0].depth.dropout = 1;
      return "dark";
  }
  return {};
}

}  // namespace calibrd::bench
