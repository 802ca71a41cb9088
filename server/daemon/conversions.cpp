// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/conversions.hpp"

#include <algorithm>
#include <numbers>

namespace calibrd {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;

ImageKind image_kind(const std::string& name) {
  if (name == "none") return ImageKind::none;
  return name == "color" ? ImageKind::color : ImageKind::infrared;
}

HealingMode healing_mode(const std::string& name) {
  if (name == "off") return HealingMode::off;
  return name == "ask" ? HealingMode::ask : HealingMode::automatic;
}

int place_of(const std::string& joint, const std::vector<std::string>& model_joints) {
  const auto found = std::find(model_joints.begin(), model_joints.end(), joint);
  return found == model_joints.end() ? -1 : static_cast<int>(found - model_joints.begin());
}

int axis_of(const std::string& joint, const RobotConfig& robot,
            const std::vector<std::string>& model_joints) {
  const auto configured = robot.joints.find(joint);
  const bool has_axis = configured != robot.joints.end() && configured->second.axis >= 0;
  return has_axis ? configured->second.axis : place_of(joint, model_joints);
}

JointMappingEntry mapping_entry(const std::string& joint, const RobotConfig& robot,
                                const std::vector<std::string>& model_joints) {
  JointMappingEntry entry;
  entry.joint = joint;
  entry.axis = axis_of(joint, robot, model_joints);
  const auto configured = robot.joints.find(joint);
  if (configured == robot.joints.end()) return entry;
  entry.sign = configured->second.sign;
  entry.scale = configured->second.scale;
  entry.offset_rad = configured->second.offset_deg * kRadPerDeg;
  for (const auto& [other, factor] : configured->second.coupling) {
    auto& coupling = entry.coupling.emplace_back();
    coupling.axis = axis_of(other, robot, model_joints);
    coupling.factor = factor;
  }
  return entry;
}

}  // namespace

api::HttpServerSettings http_settings(const Config& config) {
  api::HttpServerSettings settings;
  settings.address = config.server.address;
  settings.port = static_cast<std::uint16_t>(config.server.port);
  settings.max_connections = config.server.max_connections;
  const auto& tls = config.server.tls;
  settings.tls = {tls.certificate, tls.key, tls.key_password_file, tls.client_ca};
  settings.door.hosts = config.server.hosts;
  settings.door.rate_limit = config.server.rate_limit;
  settings.door.loopback_rate_limit = config.server.loopback_rate_limit;
  // Each sensor may have a recording that waits for the robot; what else is slow must find a worker beside
  // them.
  settings.workers += static_cast<int>(config.sensors.size());
  return settings;
}

StateClientSettings link_settings(const RobotConfig& robot) {
  StateClientSettings settings;
  settings.driver = robot.driver;
  settings.host = robot.host;
  settings.port = robot.port;
  settings.byte_order =
      robot.byte_order == "little" ? simple_message::ByteOrder::little : simple_message::ByteOrder::big;
  settings.group = robot.group;
  settings.joint_count = robot.joint_count;
  settings.real_bytes = robot.real_bytes;
  settings.max_position = robot.max_position;
  settings.max_velocity = robot.max_velocity;
  for (const auto& [lower, upper] : robot.joint_ranges) settings.joint_ranges.push_back({lower, upper});
  settings.link = {robot.link.stale_after,   robot.link.reconnect_after, robot.link.connect_timeout,
                   robot.link.backoff_first, robot.link.backoff_cap,     robot.link.eviction_within,
                   robot.link.eviction_pause};
  return settings;
}

MotionClientSettings motion_client_settings(const Config& config) {
  const auto link = link_settings(config.robot);
  MotionClientSettings settings;
  settings.host = link.host;
  settings.port = config.motion.port;
  settings.state_port = link.port;
  settings.motion.format = {link.byte_order, static_cast<std::size_t>(link.real_bytes)};
  settings.motion.group = link.group;
  settings.motion.limits = {config.motion.max_speed_deg_s * kRadPerDeg,
                            config.motion.max_acceleration_deg_s2 * kRadPerDeg};
  settings.motion.path.joint_rad = config.motion.path_tolerance_deg * kRadPerDeg;
  settings.motion.hold = config.motion.hold;
  settings.motion.connect_timeout = link.link.connect_timeout;
  // What is patient enough to calibrate is not for a robot on the move.
  settings.watch.stale_after =
      std::min<Clock::duration>(link.link.stale_after, MotionWatchSettings().stale_after);
  return settings;
}

SensorProcessSettings sensor_settings(const std::string& id, const SensorConfig& sensor) {
  SensorProcessSettings settings;
  settings.id = id;
  settings.stream.device = sensor.uri;
  settings.stream.recording = sensor.oni_file.string();
  settings.stream.loop = sensor.loop;
  settings.stream.width = sensor.camera.width;
  settings.stream.height = sensor.camera.height;
  settings.stream.fps = sensor.fps;
  settings.stream.depth_unit_um = sensor.depth_unit_um;
  settings.stream.image = image_kind(sensor.image);
  settings.stream.mirror = sensor.mirror;
  settings.openni_directory = sensor.driver_directory;
  return settings;
}

RobotMotionSettings motion_settings(const MotionConfig& motion) {
  RobotMotionSettings settings;
  settings.enabled = motion.enabled;
  settings.table_height_m = motion.table_height_m;
  for (const auto& [name, route] : motion.routes) {
    auto postures = route.postures_deg;
    for (auto& posture : postures)
      for (double& angle : posture) angle *= kRadPerDeg;
    settings.routes_rad[name] = std::move(postures);
  }
  return settings;
}

SensorSetup sensor_setup(const std::string& id, const SensorConfig& sensor) {
  SensorSetup setup{id, sensor.camera, sensor.latency, sensor.guess_T_base_sensor, {}, sensor.mirror};
  setup.estimates_time_offset = sensor.time_offset == "estimate";
  setup.rate_hz = sensor.fps;
  for (const auto& [name, p] : sensor.workspace) setup.workspace.push_back({name, {p[0], p[1], p[2]}});
  return setup;
}

DriftSettings drift_settings(const DriftConfig& drift) {
  DriftSettings settings;
  settings.shift.tolerance_m = 1e-3 * drift.tolerance_mm;
  settings.shift.tolerance_rad = 1e-3 * drift.tolerance_mrad;
  settings.shift.false_alarms_per_year = drift.false_alarms_per_year;
  settings.depth_bias_m = 1e-3 * drift.depth_bias_mm;
  settings.absorb_s = std::chrono::duration<double>(drift.absorb_after).count();
  return settings;
}

LiveCellSettings cell_settings(const Config& config, const std::string& version) {
  LiveCellSettings settings;
  settings.version = version;
  settings.urdf = config.robot.urdf;
  settings.search_paths = config.robot.search_paths;
  settings.base_link = config.robot.base_link;
  settings.joint_latency = config.robot.link.latency;
  settings.gate.stale_after = config.robot.link.stale_after;
  settings.gate.settle_time = config.calibration.settle_time;
  settings.gate.still_speed_rad_s = config.calibration.still_speed_deg_s * kRadPerDeg;
  settings.gate.trust_in_motion = config.robot.trust_in_motion;
  settings.gate.timed_views = true;  // also for checks, and for healing
  settings.jobs.collector.moving_views = config.calibration.views == "still_or_timed";
  settings.watch.max_unverified = config.pose.max_unverified;
  settings.watch.check_period = config.pose.check_period;
  settings.healing.mode = healing_mode(config.drift.healing);
  settings.healing.postures = config.drift.healing_postures;
  settings.healing.patience = config.drift.healing_patience;
  settings.healing.cooldown = config.drift.healing_cooldown;
  settings.jobs.collector.postures = config.calibration.postures;
  settings.jobs.collector.min_distance_rad = config.calibration.min_posture_distance_deg * kRadPerDeg;
  settings.jobs.collector.frames_per_posture = config.calibration.frames_per_posture;
  settings.jobs.collect_timeout = config.calibration.collect_timeout;
  settings.motion = motion_settings(config.motion);
  return settings;
}

JointMappingConfig mapping_config(const RobotConfig& robot, const std::vector<std::string>& model_joints) {
  JointMappingConfig mapping;
  mapping.axis_count = robot.joint_count;
  for (const auto& [joint, unused] : robot.joints)
    if (place_of(joint, model_joints) < 0)
      mapping.joints.push_back(mapping_entry(joint, robot, model_joints));
  for (const auto& joint : model_joints) mapping.joints.push_back(mapping_entry(joint, robot, model_joints));
  return mapping;
}

}  // namespace calibrd
