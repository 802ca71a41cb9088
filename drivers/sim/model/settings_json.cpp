// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/model/settings_json.hpp"

#include <algorithm>
#include <numbers>

namespace calibrd::sim {

namespace json = boost::json;

namespace {

constexpr double kFar_m = 100, kMany = 1e6;

Eigen::Isometry3d look_at(const Eigen::Vector3d& position, const Eigen::Vector3d& target, double roll_rad) {
  const Eigen::Vector3d z = (target - position).normalized();
  Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ());
  if (x.norm() < 1e-6) x = Eigen::Vector3d::UnitX();
  x.normalize();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << x, z.cross(x), z;
  pose.linear() = pose.linear() * Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ());
  pose.translation() = position;
  return pose;
}

Eigen::Matrix3d from_rpy(const Eigen::Vector3d& rpy_deg) {
  const Eigen::Vector3d rpy = rpy_deg * std::numbers::pi / 180;
  return (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace

void read_depth_errors(Fields& fields, DepthErrors& errors) {
  int preset = -1;
  fields.choice("preset", {"none", "kinect2"}, preset);
  if (preset >= 0) errors = preset == 1 ? DepthErrors::kinect2() : DepthErrors{};
  fields.number("noise", errors.noise, 0, 100);
  fields.flag("correlated", errors.correlated);
  fields.flag("truncated", errors.truncated);
  fields.number("offset_m", errors.offset_m, -1, 1);
  fields.number("scale", errors.scale, 0.5, 2);
  fields.number("wiggle_m", errors.wiggle_m, 0, 1);
  fields.number("wiggle_period_m", errors.wiggle_period_m, 0.01, kFar_m);
  fields.number("wiggle_phase_rad", errors.wiggle_phase_rad);
  fields.number("warmup_m", errors.warmup_m, -1, 1);
  fields.number("warmup_s", errors.warmup_s, 0.001, kMany);
  fields.number("flying_mixed", errors.flying_mixed, 0, 1);
  fields.number("flying_dropped", errors.flying_dropped, 0, 1);
  fields.number("dropout", errors.dropout, 0, 1);
  fields.number("grazing_deg", errors.grazing_deg, 0, 90);
  fields.number("min_range_m", errors.min_range_m, 0, 65);
  fields.number("max_range_m", errors.max_range_m, 0, 65);
}

json::object depth_errors_json(const DepthErrors& e) {
  return {{"noise", e.noise},
          {"correlated", e.correlated != 0},
          {"truncated", e.truncated != 0},
          {"offset_m", e.offset_m},
          {"scale", e.scale},
          {"wiggle_m", e.wiggle_m},
          {"wiggle_period_m", e.wiggle_period_m},
          {"wiggle_phase_rad", e.wiggle_phase_rad},
          {"warmup_m", e.warmup_m},
          {"warmup_s", e.warmup_s},
          {"flying_mixed", e.flying_mixed},
          {"flying_dropped", e.flying_dropped},
          {"dropout", e.dropout},
          {"grazing_deg", e.grazing_deg},
          {"min_range_m", e.min_range_m},
          {"max_range_m", e.max_range_m}};
}

void read_infrared_errors(Fields& fields, InfraredErrors& errors) {
  int preset = -1;
  fields.choice("preset", {"none", "kinect2"}, preset);
  if (preset >= 0) errors = preset == 1 ? InfraredErrors::kinect2() : InfraredErrors{};
  fields.number("gain", errors.gain, 0, kMany);
  fields.number("noise", errors.noise, 0, 100);
  fields.number("blur_px", errors.blur_px, 0, 0.7);
  fields.number("texture", errors.texture, 0, 2);
  fields.number("saturation", errors.saturation, 1, 65535);
}

json::object infrared_errors_json(const InfraredErrors& e) {
  return {{"gain", e.gain},
          {"noise", e.noise},
          {"blur_px", e.blur_px},
          {"texture", e.texture},
          {"saturation", e.saturation}};
}

void read_camera(Fields& fields, CameraParameters& camera) {
  fields.integer("width", camera.width, 16, 1024);
  fields.integer("height", camera.height, 16, 1024);
  fields.number("fx", camera.fx, 10, 10000);
  fields.number("fy", camera.fy, 10, 10000);
  fields.number("cx", camera.cx, -2048, 4096);
  fields.number("cy", camera.cy, -2048, 4096);
  std::vector<double> distortion(camera.distortion.begin(), camera.distortion.end());
  fields.numbers("distortion", distortion, camera.distortion.size());
  std::copy(distortion.begin(), distortion.end(), camera.distortion.begin());
}

json::object camera_json(const CameraParameters& c) {
  return {{"width", c.width},
          {"height", c.height},
          {"fx", c.fx},
          {"fy", c.fy},
          {"cx", c.cx},
          {"cy", c.cy},
          {"distortion", json::array(c.distortion.begin(), c.distortion.end())}};
}

void read_controller(Fields& fields, ControllerSettings& settings) {
  int mode = static_cast<int>(settings.mode), protocol = static_cast<int>(settings.protocol);
  int order = settings.big_endian, pendant = settings.automatic;
  fields.choice("mode", {"normal", "frozen", "status_only", "silent", "refuse"}, mode);
  fields.choice("protocol", {"motoros", "joint_position", "rtde"}, protocol);
  fields.choice("byte_order", {"little", "big"}, order);
  fields.flag("send_velocity", settings.send_velocity);
  fields.integer("groups", settings.groups, 1, 4);
  fields.number("rate_hz", settings.rate_hz, 0.1, 1000);
  fields.number("latency_s", settings.latency_s, 0, 10);
  fields.integer("status_every", settings.status_every, 1, 1000);
  fields.integer("send_bytes", settings.send_bytes, 0, 1000);
  fields.flag("j3_from_horizontal", settings.j3_from_horizontal);
  fields.integer("rtde_protocol", settings.rtde_protocol, 1, 2);
  fields.flag("rtde_texts", settings.rtde_texts);
  fields.text("rtde_missing", settings.rtde_missing);
  fields.flag("drives_powered", settings.drives_powered);
  fields.flag("e_stopped", settings.e_stopped);
  fields.flag("in_error", settings.in_error);
  fields.choice("pendant", {"teach", "play"}, pendant);
  fields.flag("motion_possible", settings.motion_possible);
  settings.automatic = pendant;
  settings.mode = static_cast<ControllerSettings::Mode>(mode);
  settings.protocol = static_cast<ControllerSettings::Protocol>(protocol);
  settings.big_endian = order;
}

json::object controller_json(const ControllerSettings& s) {
  constexpr const char* kModes[] = {"normal", "frozen", "status_only", "silent", "refuse"};
  constexpr const char* kProtocols[] = {"motoros", "joint_position", "rtde"};
  return {{"mode", kModes[static_cast<int>(s.mode)]},
          {"protocol", kProtocols[static_cast<int>(s.protocol)]},
          {"byte_order", s.big_endian != 0 ? "big" : "little"},
          {"send_velocity", s.send_velocity != 0},
          {"groups", s.groups},
          {"rate_hz", s.rate_hz},
          {"latency_s", s.latency_s},
          {"status_every", s.status_every},
          {"send_bytes", s.send_bytes},
          {"j3_from_horizontal", s.j3_from_horizontal != 0},
          {"rtde_protocol", s.rtde_protocol},
          {"rtde_texts", s.rtde_texts != 0},
          {"rtde_missing", s.rtde_missing},
          {"drives_powered", s.drives_powered != 0},
          {"e_stopped", s.e_stopped != 0},
          {"in_error", s.in_error != 0},
          {"pendant", s.automatic != 0 ? "play" : "teach"},
          {"motion_possible", s.motion_possible != 0}};
}

void read_person(Fields& fields, PersonState& person, std::int64_t now_ns) {
  const bool was_present = person.present != 0;
  std::vector<double> from(person.from_m.begin(), person.from_m.end()),
      to(person.to_m.begin(), person.to_m.end());
  fields.flag("present", person.present);
  fields.numbers("from_m", from, 2);
  fields.numbers("to_m", to, 2);
  fields.number("floor_z_m", person.floor_z_m, -kFar_m, kFar_m);
  fields.number("speed_m_s", person.speed_m_s, 0, 10);
  std::copy(from.begin(), from.end(), person.from_m.begin());
  std::copy(to.begin(), to.end(), person.to_m.begin());
  if (!was_present) person.since_ns = now_ns;
}

void read_pose(Fields& fields, std::string_view matrix, Eigen::Isometry3d& pose) {
  fields.matrix(matrix, pose);
  Eigen::Vector3d position = pose.translation(), target = Eigen::Vector3d::Zero(),
                  rpy = Eigen::Vector3d::Zero();
  double roll_rad = 0;
  fields.vector("position_m", position);
  fields.vector("target_m", target);
  fields.degrees("roll_deg", roll_rad);
  fields.vector("rpy_deg", rpy);
  if (fields.has("target_m")) {
    if ((target - position).norm() < 1e-3) return fields.fail("target_m", "a point away from position_m");
    pose = look_at(position, target, roll_rad);
  } else if (fields.has("roll_deg")) {
    return fields.fail("roll_deg", "a target_m with it");
  }
  pose.translation() = position;
  if (fields.has("rpy_deg")) pose.linear() = from_rpy(rpy);
}

}  // namespace calibrd::sim
