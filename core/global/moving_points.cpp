// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/moving_points.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace calibrd {
namespace {

/// With few views one that saw the background must do; with many, two guard against a stray pixel.
std::size_t needed_witnesses(std::size_t views) { return views >= 8 ? 2 : 1; }

constexpr float kOpenSpace_m = 1e3F;

/// Depth of a view with its large holes filled by open space; small ones are drop-outs and shadows of edges.
std::vector<float> with_open_space(const std::vector<float>& depth, const CameraModel& camera) {
  const int reach = std::max(2, camera.width / 100);
  const int w = camera.width, h = camera.height;
  const auto at = [w](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(w + 1) + static_cast<std::size_t>(x);
  };
  std::vector<int> measured_above_left(static_cast<std::size_t>(w + 1) * static_cast<std::size_t>(h + 1), 0);
  std::vector<float> filled = depth;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      measured_above_left[at(x + 1, y + 1)] =
          measured_above_left[at(x, y + 1)] + measured_above_left[at(x + 1, y)] -
          measured_above_left[at(x, y)] +
          (depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x)] >
           0);
  for (int y = 0; y < h; ++y) {
    const int top = std::max(y - reach, 0), bottom = std::min(y + reach + 1, h);
    for (int x = 0; x < w; ++x) {
      const int left = std::max(x - reach, 0), right = std::min(x + reach + 1, w);
      if (measured_above_left[at(right, bottom)] - measured_above_left[at(left, bottom)] -
              measured_above_left[at(right, top)] + measured_above_left[at(left, top)] ==
          0)
        filled[static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x)] =
            kOpenSpace_m;
    }
  }
  return filled;
}

/// What the other views say of one pixel.
struct Witnesses {
  std::uint8_t further = 0, open = 0, same = 0;
};

std::vector<Witnesses> question(std::span<const RegistrationView> views,
                                std::span<const std::vector<float>> filled, std::size_t own,
                                const MovingSettings& settings) {
  const std::vector<float>& depth = views[own].depth_m;
  const auto least = static_cast<float>(settings.min_step_m),
             grows = static_cast<float>(settings.min_step_per_m);
  std::vector<Witnesses> witnesses(depth.size());
  for (std::size_t other = 0; other < views.size(); ++other) {
    if (other == own) continue;
    const std::vector<float>& there = filled[other];
    for (std::size_t i = 0; i < depth.size(); ++i) {
      if (depth[i] <= 0 || there[i] <= 0) continue;
      const float step = std::max(least, grows * depth[i] * depth[i]);
      const float behind = there[i] - depth[i];
      const bool is_open = there[i] == kOpenSpace_m;
      witnesses[i].open += static_cast<std::uint8_t>(is_open);
      witnesses[i].further += static_cast<std::uint8_t>(!is_open && behind > step);
      witnesses[i].same += static_cast<std::uint8_t>(std::abs(behind) <= step);
    }
  }
  return witnesses;
}

std::vector<std::uint8_t> moving_mask(std::span<const RegistrationView> views,
                                      std::span<const std::vector<float>> filled, std::size_t own,
                                      const MovingSettings& settings) {
  const std::vector<Witnesses> witnesses = question(views, filled, own, settings);
  const std::size_t needed = needed_witnesses(views.size());
  std::vector<std::uint8_t> mask(witnesses.size());
  std::ranges::transform(witnesses, mask.begin(), [needed](const Witnesses& w) {
    // A hole may be open space, or something too near for the sensor that hides what always stands there.
    const std::size_t open = w.open > w.same ? w.open : 0;
    return static_cast<std::uint8_t>(w.further + open >= needed);
  });
  return mask;
}

/// Single pixels are noise: a moving pixel has moving neighbours on most sides.
bool is_supported(const std::vector<std::uint8_t>& mask, const CameraModel& camera, int x, int y) {
  if (x < 2 || y < 2 || x + 2 >= camera.width || y + 2 >= camera.height) return false;
  int support = 0;
  for (int dy = -2; dy <= 2; dy += 2)
    for (int dx = -2; dx <= 2; dx += 2)
      support += mask[static_cast<std::size_t>(y + dy) * static_cast<std::size_t>(camera.width) +
                      static_cast<std::size_t>(x + dx)];
  return support >= 6;
}

std::uint64_t voxel_of(const Eigen::Vector3f& p, double side) {
  constexpr std::int64_t kMiddle = 1 << 20;
  const auto cell = [&](float value) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(value / side)) + kMiddle);
  };
  return cell(p.x()) << 42 | cell(p.y()) << 21 | cell(p.z());
}

std::vector<Eigen::Vector3f> thinned(const std::vector<std::uint8_t>& mask, const RegistrationView& view,
                                     const CameraModel& camera, double voxel_m) {
  std::unordered_map<std::uint64_t, std::pair<Eigen::Vector3f, int>> cells;
  for (int y = 0; y < camera.height; y += 2) {
    for (int x = 0; x < camera.width; x += 2) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
      if (mask[i] == 0 || !is_supported(mask, camera, x, y)) continue;
      const Eigen::Vector3f p = (view.depth_m[i] * view.rays->at(x, y)).cast<float>();
      auto& [sum, count] = cells.try_emplace(voxel_of(p, voxel_m), Eigen::Vector3f::Zero(), 0).first->second;
      sum += p;
      ++count;
    }
  }
  std::vector<std::uint64_t> keys;  // sorted: the result must not depend on the hash
  for (const auto& [key, cell] : cells)
    if (cell.second >= 3) keys.push_back(key);
  std::ranges::sort(keys);
  std::vector<Eigen::Vector3f> points;
  for (const std::uint64_t key : keys) {
    const auto& [sum, count] = cells.at(key);
    points.push_back(sum / static_cast<float>(count));
  }
  return points;
}

}  // namespace

std::vector<MovingPoints> find_moving_points(std::span<const RegistrationView> views,
                                             const CameraModel& camera, const MovingSettings& settings) {
  std::vector<MovingPoints> moving(views.size());
  std::vector<std::vector<float>> filled(views.size());
  tbb::parallel_for(std::size_t{0}, views.size(),
                    [&](std::size_t v) { filled[v] = with_open_space(views[v].depth_m, camera); });
  tbb::parallel_for(std::size_t{0}, views.size(), [&](std::size_t v) {
    moving[v].mask = moving_mask(views, filled, v, settings);
    moving[v].points = thinned(moving[v].mask, views[v], camera, settings.voxel_m);
  });
  return moving;
}

std::vector<MovingPoints> robot_candidates(std::span<const RegistrationView> views,
                                           const CameraModel& camera) {
  constexpr float kFarthest_m = 4;
  if (views.size() != 1) return find_moving_points(views, camera, {});
  PixelMask near(views[0].depth_m.size());
  std::ranges::transform(views[0].depth_m, near.begin(),
                         [](float z) { return static_cast<std::uint8_t>(z > 0 && z < kFarthest_m); });
  return {{thinned(near, views[0], camera, MovingSettings{}.voxel_m), {}}};
}

}  // namespace calibrd
