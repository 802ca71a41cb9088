// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera_model.hpp"
#include "core/geometry/pose.hpp"

namespace calibrd {

using Duration = std::chrono::milliseconds;

struct TlsConfig {
  std::filesystem::path certificate;
  std::filesystem::path key;
  std::filesystem::path key_password_file;
  std::filesystem::path client_ca;
};

struct ServerConfig {
  std::string address = "127.0.0.1";
  int port = 8080;
  int max_connections = 64;
  std::filesystem::path tokens_file;
  bool allow_unauthenticated = false;
  std::vector<std::string> hosts;
  int rate_limit = 2000;
  int loopback_rate_limit = 20'000;
  std::string run_as;
  TlsConfig tls;
};

/// How one joint of the model follows the controller: see JointMappingEntry.
struct JointConfig {
  int axis = -1;  ///< place in the controller's message, from 0; -1: that of the joint in the model
  int sign = 1;
  double scale = 1;
  double offset_deg = 0;
  std::map<std::string, double> coupling;  ///< other model joint -> factor on its controller axis
};

struct LinkConfig {
  Duration stale_after{250};
  Duration reconnect_after{2000};
  Duration connect_timeout{900};
  Duration backoff_first{50};
  Duration backoff_cap{500};
  Duration eviction_within{10'000};
  Duration eviction_pause{30'000};
  Duration latency{0};
};

struct RobotConfig {
  std::filesystem::path urdf;
  std::vector<std::filesystem::path> search_paths;
  std::string base_link;
  std::string controller_frame;
  std::string driver = "simple_message";
  std::string host;
  int port = 50241;
  std::string byte_order = "big";
  int group = 0;
  int joint_count = 10;
  int real_bytes = 4;
  double max_position = 100;
  double max_velocity = 100;
  std::vector<std::array<double, 2>> joint_ranges;
  bool trust_in_motion = true;
  LinkConfig link;
  std::map<std::string, JointConfig> joints;
};

struct SensorConfig {
  std::string driver = "openni2";
  std::string uri;
  std::filesystem::path oni_file;
  std::filesystem::path driver_directory;
  bool loop = false;
  bool mirror = false;
  std::string image = "infrared";
  int fps = 30;
  CameraModel camera{.width = 512, .height = 424};
  int depth_unit_um = 1000;
  Duration latency{0};
  std::string time_offset = "estimate";
  std::optional<Pose> guess_T_base_sensor;
  std::map<std::string, std::array<double, 3>> workspace;  ///< name -> m, base frame
};

struct PoseConfig {
  Duration max_unverified{60'000};
  Duration check_period{1000};
};

struct DriftConfig {
  double tolerance_mm = 0.5, tolerance_mrad = 0.5;
  double false_alarms_per_year = 0.1;
  double depth_bias_mm = 3;
  Duration absorb_after{60'000};
  std::string healing = "automatic";
  int healing_postures = 3;
  Duration healing_patience{1500};
  Duration healing_cooldown{10'000};
};

struct CalibrationConfig {
  int postures = 5;
  double min_posture_distance_deg = 10;
  double still_speed_deg_s = 0.1;
  Duration settle_time{300};
  int frames_per_posture = 5;
  Duration collect_timeout{600'000};
  std::string views = "still";
};

struct MotionRouteConfig {
  std::vector<std::vector<double>> postures_deg;  ///< the model's order
};

struct MotionConfig {
  bool enabled = false;
  int port = 50240;
  double max_speed_deg_s = 5;
  double max_acceleration_deg_s2 = 10;
  Duration hold{2000};
  double path_tolerance_deg = 1;
  double table_height_m = 0;
  std::map<std::string, MotionRouteConfig> routes;
};

struct StorageConfig {
  std::filesystem::path path = "/var/lib/calibrd/calibrd.db";
  Duration captures_max_age = std::chrono::hours(24 * 90);
  int captures_max_mb = 2000;
};

struct AuditConfig {
  int max_file_mb = 10;
  int files = 10;
};

struct MqttTlsConfig {
  bool enabled = false;
  std::filesystem::path ca, certificate, key;
};

struct MqttConfig {
  std::string host;  ///< empty: nothing is published
  int port = 0;
  std::string cell;
  std::string prefix = "calibrd";
  std::string username;
  std::filesystem::path password_file;
  MqttTlsConfig tls;
};

struct LogConfig {
  std::string level = "info";
  std::string format = "text";
};

/// Everything that can be configured. Each key, its range and its meaning are declared in settings_table.cpp.
struct Config {
  ServerConfig server;
  RobotConfig robot;
  std::map<std::string, SensorConfig> sensors;
  PoseConfig pose;
  DriftConfig drift;
  CalibrationConfig calibration;
  MotionConfig motion;
  StorageConfig storage;
  AuditConfig audit;
  MqttConfig mqtt;
  LogConfig log;
};

}  // namespace calibrd
