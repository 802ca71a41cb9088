// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/moving_scene.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd::bench {
namespace {

constexpr double kPiece_rad = 0.004, kCycle_s = 0.025;
constexpr double kSlowest_m_s = 0.01;

/// Straight from `from` on, without its end.
void append_straight(const std::vector<double>& from, const std::vector<double>& to,
                     std::vector<std::vector<double>>& path) {
  double farthest = 0;
  for (std::size_t j = 0; j < from.size(); ++j) farthest = std::max(farthest, std::abs(to[j] - from[j]));
  const int pieces = std::max(2, static_cast<int>(farthest / kPiece_rad));
  for (int i = 0; i < pieces; ++i) {
    auto& point = path.emplace_back(from);
    for (std::size_t j = 0; j < from.size(); ++j) point[j] += (to[j] - from[j]) * i / pieces;
  }
}

}  // namespace

MovingScene::MovingScene(const Scene& scene, const sim::CaptureOptions& capture, const MovingOptions& options,
                         const std::shared_ptr<const sim::SensorTables>& tables)
    : scene_(scene),
      options_(options),
      random_(scene.truth.seed),  // the same cell as the scene's
      furnished_(
          sim::furnish(scene.robot->simulated, capture.level, tables->grid.camera.parameters(), random_)),
      model_(furnished_.cell, tables) {
  furnished_.state.sensors[0].T_base_sensor = sim::PoseValues::of(scene.truth.T_base_sensor);
  const auto& names = scene.robot->model.position_names();
  for (const auto& range : scene.robot->simulated.positions)
    places_.push_back(static_cast<std::size_t>(std::ranges::find(names, range.name) - names.begin()));
  std::vector<std::size_t> corners;
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    corners.push_back(path_.size());
    append_straight(scene.true_joints_rad(v), scene.true_joints_rad((v + 1) % scene.views.size()), path_);
    middles_.push_back((corners.back() + path_.size()) / 2);
  }
  corners.push_back(path_.size());
  path_.push_back(path_.front());
  const LinkReach reach(scene.robot->model);
  std::vector<double> way_m{0};
  for (std::size_t i = 1; i < path_.size(); ++i)
    way_m.push_back(way_m.back() + reach.farthest_m(path_[i - 1], path_[i]));
  times_s_.push_back(0);
  for (std::size_t i = 1, leg = 0; i < path_.size(); ++i) {
    while (corners[leg + 1] < i) ++leg;
    const double middle_m = 0.5 * (way_m[i - 1] + way_m[i]);
    const double left_m = std::min(middle_m - way_m[corners[leg]], way_m[corners[leg + 1]] - middle_m);
    const double speed = std::clamp(std::sqrt(2 * options.acceleration_m_s2 * std::max(left_m, 0.0)),
                                    kSlowest_m_s, options.speed_m_s);
    times_s_.push_back(times_s_.back() + (way_m[i] - way_m[i - 1]) / speed);
  }
}

std::vector<double> MovingScene::middles_s() const {
  std::vector<double> times;
  for (const std::size_t i : middles_) times.push_back(times_s_[i]);
  return times;
}

/// True joints, order of the model.
std::vector<double> MovingScene::path_at(double time_s) const {
  const double time = time_s - std::floor(time_s / lap_s()) * lap_s();
  const auto after = std::ranges::upper_bound(times_s_, time);
  const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
      after - times_s_.begin(), 1, static_cast<std::ptrdiff_t>(times_s_.size()) - 1));
  const double share = (time - times_s_[i - 1]) / (times_s_[i] - times_s_[i - 1]);
  auto joints = path_[i - 1];
  for (std::size_t j = 0; j < joints.size(); ++j) joints[j] += share * (path_[i][j] - joints[j]);
  return joints;
}

std::vector<double> MovingScene::reported_joints(double time_s) const {
  auto joints = path_at(time_s);
  for (std::size_t j = 0; j < joints.size(); ++j) joints[j] -= scene_.joint_zeros_rad[j];
  return joints;
}

View MovingScene::expose(double time_s, std::uint64_t seed) {
  auto& state = furnished_.state;
  sim::Joints posture{};
  const auto joints = path_at(time_s);
  for (std::size_t i = 0; i < places_.size(); ++i) posture[i] = joints[places_[i]];
  state.motion.place(posture, 0);
  const auto& camera = scene_.camera;
  const auto pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  View view{{camera.width, camera.height, 0.001, std::vector<std::uint16_t>(pixels)},
            GreyImage{camera.width, camera.height, std::vector<std::uint16_t>(pixels)},
            {},
            0};
  model_.expose(state, state.sensors[0], std::llround(1e9 * (time_s + 3)), seed, view.depth.raw,
                view.image->pixels);
  sim::Random random(seed ^ 0x717e);
  view.stamp_s = time_s + options_.frame_latency_s -
                 options_.frame_jitter_s * std::log(1 - random.uniform(0, 1) * 0.999);
  return view;
}

JointHistory MovingScene::joints(double begin_s, double time_s) const {
  JointHistory history(std::chrono::hours(1));
  for (double t = std::ceil(begin_s / kCycle_s) * kCycle_s; t + options_.joint_latency_s <= time_s;
       t += kCycle_s)
    history.add({reported_joints(t), {}, 0, clock_at(t + options_.joint_latency_s)});
  return history;
}

Clock::time_point MovingScene::clock_at(double time_s) {
  return Clock::time_point(std::chrono::hours(1)) +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(time_s));
}

}  // namespace calibrd::bench
