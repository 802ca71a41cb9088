// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace calibrd {

/// Monotonic: the clock every frame and joint state of the live cell is stamped with.
using Clock = std::chrono::steady_clock;

/// Depth along the optical axis in whole units of `scale_m`; 0 = no measurement. Row-major, width*height
/// values.
struct DepthImage {
  int width = 0;
  int height = 0;
  double scale_m = 0.001;
  std::vector<std::uint16_t> raw;

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  double depth_m(int x, int y) const { return raw[index(x, y)] * scale_m; }
};

/// Infrared or luminance in the depth image's pixel grid. Row-major, width*height values.
struct GreyImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> pixels;
};

/// What a depth sensor delivered at one moment.
struct DepthFrame {
  DepthImage depth;
  std::optional<GreyImage> image;  ///< of the same moment, where the device gives one
  std::uint64_t sequence = 0;      ///< counts up by one per frame of the device; gaps are lost frames
  Clock::time_point stamp;         ///< monotonic time of reception from the device
};

/// The joint positions a controller reported, in the robot model's joint order.
struct JointState {
  std::vector<double> positions_rad;   ///< m for prismatic joints
  std::vector<double> velocities_rad;  ///< per second; empty when the controller gives none
  std::uint64_t sequence = 0;          ///< counts messages received since start; never repeats a value
  Clock::time_point stamp;             ///< monotonic time of reception
};

}  // namespace calibrd
