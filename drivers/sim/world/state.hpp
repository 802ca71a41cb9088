// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <type_traits>

#include "drivers/sim/world/motion.hpp"

namespace calibrd::sim {

inline constexpr int kMaxSensors = 8;
inline constexpr int kMaxObjects = 64;
inline constexpr int kMaxName = 48;

/// A rigid transform as plain numbers, three rows of four.
struct PoseValues {
  std::array<double, 12> rows{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

  static PoseValues of(const Eigen::Isometry3d& pose);
  Eigen::Isometry3d pose() const;
  bool operator==(const PoseValues&) const = default;
};

/// Pixel (x, y) sees along ((x-cx)/fx, (y-cy)/fy, 1), distortion (k1, k2, p1, p2, k3 as OpenCV) undone.
/// Pixels.
struct CameraParameters {
  std::int32_t width = 512, height = 424;
  double fx = 365.6, fy = 365.6, cx = 254.9, cy = 205.4;
  std::array<double, 5> distortion{};
};

/// Errors of the depth: z_measured = scale * z + offset + wiggle * sin(2 pi z / period + phase) + warm-up +
/// noise, z along the optical axis. Every part can be switched off by its own zero (scale by one).
struct DepthErrors {
  double noise = 0;             ///< factor on Fankhauser's axial noise (2015); 1 = as a Kinect v2
  std::int32_t correlated = 0;  ///< 1: the noise is averaged over 3x3 pixels, its standard deviation kept
  std::int32_t truncated = 0;   ///< 1: whole mm by cutting off, as libfreenect2 does; 0: by rounding
  double offset_m = 0;
  double scale = 1;
  double wiggle_m = 0;
  double wiggle_period_m = 0.9375;
  double wiggle_phase_rad = 0;
  double warmup_m = 0;  ///< offset at switch-on, dies away with `warmup_s`
  double warmup_s = 600;
  double flying_mixed = 0;    ///< part of the edge pixels that report a mixture of both depths
  double flying_dropped = 0;  ///< part of the edge pixels that report nothing
  double dropout = 0;         ///< part of all pixels that report nothing
  double grazing_deg = 90;    ///< incidence from which pixels begin to drop out; 90 = never
  double min_range_m = 0.0;
  double max_range_m = 65.0;

  static DepthErrors kinect2();
  bool operator==(const DepthErrors&) const = default;
};

/// The infrared image: `gain` * albedo * cos(incidence) / distance^2, in counts of 0..65535.
struct InfraredErrors {
  double gain = 20000;  ///< counts at 1 m, facing, albedo 1
  double noise = 0;     ///< factor on shot and read noise; 1 = as a Kinect v2
  double blur_px = 0;   ///< standard deviation of the lens's blur, at most 0.7
  double texture = 0;   ///< factor on every surface's mottling
  double saturation = 65535;

  static InfraredErrors kinect2();
};

enum class SensorMode : std::int32_t {
  normal,
  silent,
  hanging,
  unplugged,
  replay  ///< the frames of some moments again and again: for who measures what frames cost but their making
};
inline constexpr const char* kSensorModes[] = {"normal", "silent", "hanging", "unplugged", "replay"};

struct SensorState {
  std::array<char, kMaxName> id{};
  PoseValues T_base_sensor;
  CameraParameters camera;
  double rate_hz = 30;
  double latency_s = 0.020;  ///< from the exposure to the frame's delivery
  DepthErrors depth;
  InfraredErrors infrared;
  SensorMode mode = SensorMode::normal;
  std::uint32_t crashes = 0;    ///< counts up: every driver alive then crashes once
  std::int64_t powered_ns = 0;  ///< when it was switched on (warm-up)
};

struct ObjectState {
  PoseValues T_base_object;
  std::int32_t present = 1;
  bool operator==(const ObjectState&) const = default;
};

/// A second robot of the same make that stands still.
struct OtherRobotState {
  PoseValues T_base_other;
  Joints joints{};
  std::int32_t present = 0;
  bool operator==(const OtherRobotState&) const = default;
};

/// A person who walks to and fro between two places (base frame, m), feet at floor_z_m.
struct PersonState {
  std::int32_t present = 0;
  std::int64_t since_ns = 0;
  std::array<double, 2> from_m{1.2, -1.5}, to_m{1.2, 1.5};
  double floor_z_m = -0.8;
  double speed_m_s = 0.8;
};

/// All that changes in the simulated cell. Plain data, so that it can go through shared memory between the
/// simulator and the driver of the same build.
struct WorldState {
  MotionPlan motion;
  Joints joint_zero_rad{};  ///< true minus reported position of each joint
  std::int32_t joint_count = 0;
  std::int32_t sensor_count = 0;
  std::int32_t object_count = 0;
  std::array<SensorState, kMaxSensors> sensors{};
  std::array<ObjectState, kMaxObjects> objects{};
  OtherRobotState other_robot;
  PersonState person;

  /// What the controller knows: true positions less the zero errors.
  Joints reported_at(std::int64_t now_ns) const;
};

static_assert(std::is_trivially_copyable_v<WorldState>);

/// Nanoseconds of CLOCK_MONOTONIC: the one clock of the world.
std::int64_t monotonic_ns();

}  // namespace calibrd::sim
