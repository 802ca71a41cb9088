// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/robot_drivers.hpp"
#include "server/config/section_declarer.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;

void declare_robot(std::vector<Setting>& table) {
  SectionDeclarer<RobotConfig> key(table, {"robot"},
                                   [](Config& c, const Names&) -> RobotConfig& { return c.robot; });
  key("urdf", &RobotConfig::urdf, path(), "", "Robot model.").required = true;
  key("search_paths", &RobotConfig::search_paths, paths(), "",
      "Folders where package://NAME/… and relative meshes are looked up, after the URDF's own folder.");
  key("base_link", &RobotConfig::base_link, text(), "",
      "Link whose frame is the base of every published pose. Empty: the URDF's root.");
  key("controller_frame", &RobotConfig::controller_frame, text(), "",
      "Link whose frame the controller calls its base, still to base_link; needed for the pose formats of "
      "controllers: docs/pose_formats.md.");
  key("driver", &RobotConfig::driver, one_of(robot_driver_names()), "",
      "How joints are read from the controller: docs/controllers.md names the makes.");
  key("host", &RobotConfig::host, text(), "", "Name or address of the robot controller.").required = true;
  key("port", &RobotConfig::port, integer(1, 65535), "",
      "State port of the controller (MotoROS 50241; FANUC and ABB 11002). ur_rtde: 30004 when it is not "
      "set.");
  key("byte_order", &RobotConfig::byte_order, one_of({"big", "little"}), "",
      "Byte order of the controller (FS100 and FANUC big; DX100, DX200, YRC1000 and ABB little). "
      "simple_message.");
  key("group", &RobotConfig::group, integer(0, 3), "", "Motion group to follow, from 0. simple_message.");
  key("joint_count", &RobotConfig::joint_count, integer(1, 10), "",
      "How many values of a message are taken, from the first. ur_rtde: 6 when it is not set.");
  key("real_bytes", &RobotConfig::real_bytes, one_of_numbers({4, 8}), "",
      "Size of the protocol's reals; 8 only for servers built so. simple_message.");
  key("max_position", &RobotConfig::max_position, positive_real(), "rad, m",
      "A message with a position beyond it is damage and is dropped.");
  key("max_velocity", &RobotConfig::max_velocity, positive_real(), "rad/s, m/s",
      "A message with a velocity beyond it is damage and is dropped.");
  key("joint_ranges", &RobotConfig::joint_ranges, ranges(), "rad, m",
      "Where each joint can be, [lower, upper] in wire order; a message outside is dropped.");
  key("trust_in_motion", &RobotConfig::trust_in_motion, flag(), "",
      "A robot whose controller says that it is in motion gives no view of a still robot, and joints that "
      "repeat meanwhile are frozen. false: for controllers that say so while the robot stands.");
}

void declare_link(std::vector<Setting>& table) {
  SectionDeclarer<LinkConfig> key(table, {"robot", "link"},
                                  [](Config& c, const Names&) -> LinkConfig& { return c.robot.link; });
  key("stale_after", &LinkConfig::stale_after, duration(50ms, 10s), "",
      "Joints older than this are not used.");
  key("reconnect_after", &LinkConfig::reconnect_after, duration(500ms, 60s), "",
      "Silence after which the connection is made anew.");
  key("connect_timeout", &LinkConfig::connect_timeout, duration(100ms, 60s), "",
      "For one attempt, name look-up included.");
  key("backoff_first", &LinkConfig::backoff_first, duration(10ms, 60s), "",
      "Pause before the first new attempt; doubles up to backoff_cap.");
  key("backoff_cap", &LinkConfig::backoff_cap, duration(10ms, 10min), "", "Longest pause between attempts.");
  key("eviction_within", &LinkConfig::eviction_within, duration(0ms, 10min), "",
      "A connection closed so soon after it was accepted has lost its slot to another client.");
  key("eviction_pause", &LinkConfig::eviction_pause, duration(0ms, 1h), "",
      "Pause after two such closes in a row.");
  key("latency", &LinkConfig::latency, duration(0ms, 1s), "",
      "From the moment joints were where a message says to its arrival; it is taken off their stamp.");
}

void declare_joints(std::vector<Setting>& table) {
  SectionDeclarer<JointConfig> key(
      table, {"robot", "joints", "*"},
      [](Config& c, const Names& n) -> JointConfig& { return c.robot.joints[n[0]]; });
  key("axis", &JointConfig::axis, integer(-1, 9), "",
      "Place of this joint in the controller's message, from 0. -1: its place in the model.");
  key("sign", &JointConfig::sign, one_of_numbers({1, -1}), "",
      "1, or -1 where controller and model turn in opposite directions.");
  key("scale", &JointConfig::scale, real(1e-6, 1e6), "", "Model units per controller unit.");
  key("offset_deg", &JointConfig::offset_deg, real(-720, 720), "deg",
      "Model position where the controller says 0.");
}

void declare_coupling(std::vector<Setting>& table) {
  Setting setting;
  setting.path = {"robot", "joints", "*", "coupling", "*"};
  const auto kind = real(-1e3, 1e3);
  setting.type = kind.name;
  setting.meaning =
      "Factor by which the controller axis of another joint moves this one (FANUC: joint_3 follows joint_2).";
  setting.set = [kind](Config& config, const Names& names, const RawValue& raw) -> Status {
    auto value = kind.read(raw);
    if (!value) return value.error();
    config.robot.joints[names[0]].coupling[names[1]] = *value;
    return Done{};
  };
  setting.toml = [kind](const Config& config, const Names& names) {
    const auto joint = config.robot.joints.find(names[0]);
    if (joint == config.robot.joints.end() || !joint->second.coupling.contains(names[1]))
      return std::string();
    return kind.write(joint->second.coupling.at(names[1]));
  };
  table.push_back(std::move(setting));
}

void declare_sensors(std::vector<Setting>& table) {
  SectionDeclarer<SensorConfig> key(
      table, {"sensors", "*"}, [](Config& c, const Names& n) -> SensorConfig& { return c.sensors[n[0]]; });
  key("driver", &SensorConfig::driver, one_of({"openni2"}), "", "How frames are read.");
  key("uri", &SensorConfig::uri, text(), "",
      "OpenNI2 device: a URI, a pattern for URIs (with *), or serial:NUMBER. Empty: the first device found.");
  key("oni_file", &SensorConfig::oni_file, path(), "", "Recording to play instead of a device.");
  key("loop", &SensorConfig::loop, flag(), "", "Plays the recording again and again.");
  key("driver_directory", &SensorConfig::driver_directory, path(), "",
      "Folder with libOpenNI2.so.0 and OpenNI2/Drivers/lib….so.0 to use. Empty: those of the system.");
  key("image", &SensorConfig::image, one_of({"infrared", "color", "none"}), "",
      "Image stream read beside the depth.");
  key("mirror", &SensorConfig::mirror, flag(), "",
      "Flips every row; only for drivers that deliver mirrored images and deny it.");
  const auto camera = [](auto member) {
    return [member](SensorConfig & sensor) -> auto& { return sensor.camera.*member; };
  };
  key("width", camera(&CameraModel::width), integer(16, 8192), "px",
      "Width of the depth image; set on the device.");
  key("height", camera(&CameraModel::height), integer(16, 8192), "px",
      "Height of the depth image; set on the device.");
  key("fps", &SensorConfig::fps, integer(2, 120), "1/s", "Frame rate set on the device.");
  key("fx", camera(&CameraModel::fx), positive_real(), "px",
      "Focal length. What the device reports is not used: drivers report wrong fields of view. Wrong "
      "intrinsics cannot be seen from the views alone: 2.6 % off here moved the pose by 39 mm, at a claimed "
      "sigma of 0.8 mm.")
      .required = true;
  key("fy", camera(&CameraModel::fy), positive_real(), "px", "Focal length.").required = true;
  key("cx", camera(&CameraModel::cx), positive_real(), "px",
      "Principal point; the centre of the first pixel is 0. Taken as the centre of the image it moved the "
      "pose by up to 29 mm, unseen.")
      .required = true;
  key("cy", camera(&CameraModel::cy), positive_real(), "px", "Principal point.").required = true;
  key("distortion", camera(&CameraModel::distortion), five_reals(), "",
      "k1, k2, p1, p2, k3 as OpenCV defines them. Left out it moved the pose by 5 mm, unseen.");
  key("depth_unit_um", &SensorConfig::depth_unit_um, one_of_numbers({1000, 100}), "µm",
      "Unit of the depth values to ask the device for; the other one is taken where it is not offered.");
}

void declare_sensors_time_and_place(std::vector<Setting>& table) {
  SectionDeclarer<SensorConfig> key(
      table, {"sensors", "*"}, [](Config& c, const Names& n) -> SensorConfig& { return c.sensors[n[0]]; });
  key("latency", &SensorConfig::latency, duration(0ms, 1s), "",
      "From exposure to the arrival of a frame; it is taken off the frame's stamp.");
  key("time_offset", &SensorConfig::time_offset, one_of({"estimate", "off"}), "",
      "estimate: how much later frames are stamped than joints, beyond both latencies, is found from the "
      "robot's motion once the sensor is calibrated, and applied. off: the latencies are taken for true.");
  key("guess", &SensorConfig::guess_T_base_sensor, optional_pose(), "m",
      "Rough T_base_sensor; only makes the first calibration faster.");
}

void declare_workspace(std::vector<Setting>& table) {
  Setting setting;
  setting.path = {"sensors", "*", "workspace", "*"};
  const auto kind = three_reals();
  setting.type = "[x, y, z]";
  setting.unit = "m";
  setting.meaning =
      "Point of the base frame where the pose must be good: every calibration tells its predicted error "
      "there.";
  setting.set = [kind](Config& config, const Names& names, const RawValue& raw) -> Status {
    auto value = kind.read(raw);
    if (!value) return value.error();
    config.sensors[names[0]].workspace[names[1]] = *value;
    return Done{};
  };
  setting.toml = [kind](const Config& config, const Names& names) {
    const auto sensor = config.sensors.find(names[0]);
    if (sensor == config.sensors.end() || !sensor->second.workspace.contains(names[1])) return std::string();
    return kind.write(sensor->second.workspace.at(names[1]));
  };
  table.push_back(std::move(setting));
}

void declare_pose(std::vector<Setting>& table) {
  SectionDeclarer<PoseConfig> key(table, {"pose"},
                                  [](Config& c, const Names&) -> PoseConfig& { return c.pose; });
  key("max_unverified", &PoseConfig::max_unverified, duration(1s, 24h), "",
      "A pose whose last passed check is older than this is not served as valid.");
  key("check_period", &PoseConfig::check_period, duration(100ms, 1h), "",
      "Time between checks of the pose; one is made only while the robot is still.");
}

void declare_calibration(std::vector<Setting>& table) {
  SectionDeclarer<CalibrationConfig> key(
      table, {"calibration"}, [](Config& c, const Names&) -> CalibrationConfig& { return c.calibration; });
  key("postures", &CalibrationConfig::postures, integer(1, 50), "",
      "Postures collected for a calibration when the request names no number.");
  key("min_posture_distance_deg", &CalibrationConfig::min_posture_distance_deg, real(0.1, 180), "deg",
      "A posture counts as another one when some joint differs by this much.");
  key("still_speed_deg_s", &CalibrationConfig::still_speed_deg_s, real(0.001, 10), "deg/s",
      "The robot is still while no joint is faster than this.");
  key("settle_time", &CalibrationConfig::settle_time, duration(0ms, 10s), "",
      "The robot must have been still for this long before a frame.");
  key("frames_per_posture", &CalibrationConfig::frames_per_posture, integer(1, 60), "",
      "Frames averaged for each posture.");
  key("collect_timeout", &CalibrationConfig::collect_timeout, duration(1s, 24h), "",
      "A calibration that has not seen its postures after this time fails.");
  key("views", &CalibrationConfig::views, one_of({"still", "still_or_timed"}), "",
      "still_or_timed: frames of a moving robot are used as well, where the time offset is known so well "
      "that no point of it is farther than 0.3 mm from where the joints put it.");
}

void declare_rest(std::vector<Setting>& table) {
  SectionDeclarer<StorageConfig> storage(table, {"storage"},
                                         [](Config& c, const Names&) -> StorageConfig& { return c.storage; });
  storage("path", &StorageConfig::path, path(), "",
          "SQLite file with every calibration ever made. Its folder is made when absent.");
  storage("captures_max_age", &StorageConfig::captures_max_age, duration(0ms, 24h * 365 * 10), "",
          "The views of a calibration are kept in captures/ beside it for this long. 0s: not at all.");
  storage("captures_max_mb", &StorageConfig::captures_max_mb, integer(0, 10'000'000), "MB",
          "All of them take no more; the oldest go first. 0: none are kept.");
  declare_audit(table);
  declare_mqtt(table);
  SectionDeclarer<LogConfig> log(table, {"log"}, [](Config& c, const Names&) -> LogConfig& { return c.log; });
  log("level", &LogConfig::level, one_of({"trace", "debug", "info", "warn", "error"}), "",
      "Least severe message that is logged (to stderr).")
      .live = true;
  log("format", &LogConfig::format, one_of({"text", "json"}), "",
      "text for people, json for one JSON object per line.");
}

std::vector<Setting> build_table() {
  std::vector<Setting> table;
  declare_server(table);
  declare_robot(table);
  declare_link(table);
  declare_joints(table);
  declare_coupling(table);
  declare_sensors(table);
  declare_sensors_time_and_place(table);
  declare_workspace(table);
  declare_pose(table);
  declare_drift(table);
  declare_calibration(table);
  declare_motion(table);
  declare_rest(table);
  return table;
}

}  // namespace

const std::vector<Setting>& settings_table() {
  static const std::vector<Setting> table = build_table();
  return table;
}

}  // namespace calibrd
