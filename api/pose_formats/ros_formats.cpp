// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/array.hpp>

#include "api/json/pose_json.hpp"
#include "api/pose_formats/euler_angles.hpp"
#include "api/pose_formats/pose_text.hpp"
#include "api/pose_formats/writers.hpp"
#include "core/geometry/canonical_rotation.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;
using WriteFrame = void (*)(json::object&, const FramedPose&);

/// REP 103: a camera has two frames, NAME (x forward, y left, z up) and NAME_optical.
FramedPose body_frame(const FramedPose& optical) {
  Eigen::Matrix3d R_optical_body;
  R_optical_body << 0, -1, 0,  //
      0, 0, -1,                //
      1, 0, 0;
  FramedPose body = optical;
  body.T_to_from.linear() = optical.T_to_from.linear() * R_optical_body;
  const std::string suffix = "_optical";
  auto& name = body.from_frame;
  if (name.size() > suffix.size() && name.ends_with(suffix))
    name.resize(name.size() - suffix.size());
  else
    name += "_body";
  return body;
}

/// The numbers of the optical frame, and under "body" those of the frame beside it: who starts a driver that
/// publishes NAME -> NAME_optical itself must publish the body frame, for a frame has one parent only.
void write_both(json::object& payload, const FramedPose& optical, WriteFrame write) {
  write(payload, optical);
  const auto body = body_frame(optical);
  json::object beside{
      {"from_frame", body.from_frame},
      {"to_frame", body.to_frame},
      {"axes", "x forward, y left, z up"},
      {"when", "instead of " + optical.from_frame + ", where a driver publishes " + optical.from_frame +
                   " below " + body.from_frame + ": a frame has one parent only"}};
  write(beside, body);
  payload["body"] = std::move(beside);
}

void write_ros2_frame(json::object& body, const FramedPose& pose) {
  const auto& t = pose.T_to_from.translation();
  const auto q = canonical_quaternion(pose.T_to_from.linear());
  const auto [yaw, pitch, roll] = zyx_angles(pose.T_to_from.linear());
  body["translation_m"] = translation_json(pose.T_to_from);
  body["rotation_xyzw"] = rotation_xyzw_json(pose.T_to_from);
  body["roll_pitch_yaw_rad"] = json::array{roll, pitch, yaw};
  body["text"] = "ros2 run tf2_ros static_transform_publisher --x " + decimals(t.x()) + " --y " +
                 decimals(t.y()) + " --z " + decimals(t.z()) + " --qx " + decimals(q.x()) + " --qy " +
                 decimals(q.y()) + " --qz " + decimals(q.z()) + " --qw " + decimals(q.w()) + " --frame-id " +
                 shell_word(pose.to_frame) + " --child-frame-id " + shell_word(pose.from_frame);
}

void write_ros1_frame(json::object& body, const FramedPose& pose) {
  const auto& t = pose.T_to_from.translation();
  const auto q = canonical_quaternion(pose.T_to_from.linear());
  const auto [yaw, pitch, roll] = zyx_angles(pose.T_to_from.linear());
  body["translation_m"] = translation_json(pose.T_to_from);
  body["rotation_xyzw"] = rotation_xyzw_json(pose.T_to_from);
  body["yaw_pitch_roll_rad"] = json::array{yaw, pitch, roll};
  const auto arguments = decimal_list({t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}, " ") + " " +
                         shell_word(pose.to_frame) + " " + shell_word(pose.from_frame);
  body["text"] = "rosrun tf2_ros static_transform_publisher " + arguments;
  body["text_tf"] = "rosrun tf static_transform_publisher " + arguments + " 100";
}

void write_urdf_frame(json::object& body, const FramedPose& pose) {
  const auto& t = pose.T_to_from.translation();
  const auto [yaw, pitch, roll] = zyx_angles(pose.T_to_from.linear());
  body["xyz_m"] = translation_json(pose.T_to_from);
  body["rpy_rad"] = json::array{roll, pitch, yaw};
  const auto origin = "<origin xyz=\"" + decimal_list({t.x(), t.y(), t.z()}, " ") + "\" rpy=\"" +
                      decimal_list({roll, pitch, yaw}, " ") + "\"/>";
  const auto parent = xml_attribute(pose.to_frame), child = xml_attribute(pose.from_frame);
  body["text"] = origin;
  body["text_joint"] = "<link name=\"" + child + "\"/><joint name=\"" + parent + "_to_" + child +
                       "\" type=\"fixed\"><parent link=\"" + parent + "\"/><child link=\"" + child + "\"/>" +
                       origin + "</joint>";
}

}  // namespace

void write_ros2(json::object& body, const FramedPose& pose) { write_both(body, pose, write_ros2_frame); }
void write_ros1(json::object& body, const FramedPose& pose) { write_both(body, pose, write_ros1_frame); }
void write_urdf(json::object& body, const FramedPose& pose) { write_both(body, pose, write_urdf_frame); }

}  // namespace calibrd::api
