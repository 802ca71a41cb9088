// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/pose_formats/pose_format.hpp"

#include <algorithm>
#include <array>

#include "api/pose_formats/writers.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

constexpr auto kBase = Reference::base;
constexpr auto kController = Reference::controller;
constexpr auto kInverse = Reference::inverse;

constexpr const char* kQuaternion =
    "unit quaternion of R, x y z w (w is the real part); w >= 0, and at w = 0 the first of x, y, z that is "
    "not 0 is positive";
constexpr const char* kVector =
    "rotation vector of R: axis times angle, angle 0 to pi; at pi the first of its numbers that is not 0 is "
    "positive";
constexpr const char* kRos =
    "unit quaternion of R, x y z w (w is the real part), w >= 0; or R = Rz(yaw) Ry(pitch) Rx(roll): about "
    "fixed x, y, z in this order";
constexpr const char* kRosLock = "at pitch = ±pi/2 roll is 0";
constexpr const char* kTf2Source =
    "https://github.com/ros2/geometry2 tf2_ros/src/static_transform_broadcaster_program.cpp; frames: REP "
    "103, "
    "https://www.ros.org/reps/rep-0103.html";
constexpr const char* kTfSource =
    "https://github.com/ros/geometry2 tf2_ros/src/static_transform_broadcaster_program.cpp; with a period in "
    "ms: "
    "https://wiki.ros.org/tf#static_transform_publisher; frames: REP 103, "
    "https://www.ros.org/reps/rep-0103.html";

// clang-format off
constexpr std::array kFormats{
    PoseFormat{"matrix", kBase, "m", nullptr, "4x4, row-major",
               "T_base_sensor = [R t; 0 0 0 1]", nullptr,
               "homogeneous transformation: Lynch, Park: Modern Robotics (2017), 3.3.1", write_matrix},
    PoseFormat{"quaternion", kBase, "m", nullptr, "translation x y z, quaternion x y z w", kQuaternion, nullptr,
               "https://docs.ros.org/en/noetic/api/geometry_msgs/html/msg/Quaternion.html", write_quaternion},
    PoseFormat{"rotvec", kBase, "m", "rad", "translation x y z, rotation vector x y z", kVector, nullptr,
               "exponential coordinates: Lynch, Park: Modern Robotics (2017), 3.2.3; as "
               "https://docs.scipy.org/doc/scipy/reference/generated/scipy.spatial.transform.Rotation.as_rotvec.html", write_rotvec},
    PoseFormat{"ros2", kBase, "m", "rad", "x y z, qx qy qz qw; roll pitch yaw", kRos, kRosLock, kTf2Source, write_ros2},
    PoseFormat{"ros1", kBase, "m", "rad", "x y z, qx qy qz qw; yaw pitch roll (the publishers' order)", kRos, kRosLock, kTfSource, write_ros1},
    PoseFormat{"urdf", kBase, "m", "rad", "xyz, rpy (roll pitch yaw)",
               "R = Rz(yaw) Ry(pitch) Rx(roll): about fixed x, y, z in this order", kRosLock,
               "https://wiki.ros.org/urdf/XML/joint", write_urdf},
    PoseFormat{"kuka", kController, "mm", "deg", "X Y Z A B C",
               "R = Rz(A) Ry(B) Rx(C): about z, the new y, the newest x", "at B = ±90 C is 0",
               "KRL FRAME; https://docs.baslerweb.com/stereovisard/rc_visard/en/pose_format_kuka.html", write_kuka},
    PoseFormat{"fanuc", kController, "mm", "deg", "X Y Z W P R",
               "R = Rz(R) Ry(P) Rx(W): about fixed x, y, z in this order", "at P = ±90 W is 0",
               "https://docs.baslerweb.com/stereovisard/rc_cube/en/pose_format_fanuc", write_fanuc},
    PoseFormat{"yaskawa", kController, "mm", "deg", "X Y Z Rx Ry Rz",
               "R = Rz(Rz) Ry(Ry) Rx(Rx): about fixed x, y, z in this order", "at Ry = ±90 Rx is 0",
               "https://docs.baslerweb.com/stereovisard/rc_cube/en/pose_format_yaskawa", write_yaskawa},
    PoseFormat{"mitsubishi", kController, "mm", "deg", "X Y Z A B C",
               "R = Rz(C) Ry(B) Rx(A): about fixed x, y, z in this order (A and C the other way round than KUKA)",
               "at B = ±90 A is 0",
               "MELFA-BASIC position constant (P_.A, .B, .C in programs are rad); "
               "https://docs.baslerweb.com/stereovisard/rc_visard/en/pose_format_mitsubishi", write_mitsubishi},
    PoseFormat{"kawasaki", kController, "mm", "deg", "X Y Z O A T",
               "R = Rz(O) Ry(A) Rz(T): about z, the new y, the newest z; A is 0 to 180", "at A = 0 and A = 180 T is 0",
               "AS language TRANS; https://docs.baslerweb.com/stereovisard/rc_cube/en/pose_format_kawasaki", write_kawasaki},
    PoseFormat{"abb", kController, "mm", nullptr, "trans x y z, rot q1 q2 q3 q4",
               "unit quaternion of R, q1 q2 q3 q4 = w x y z (q1 is the real part); q1 >= 0, and at q1 = 0 the first of "
               "the others that is not 0 is positive", nullptr,
               "RAPID Reference Manual, data types pose and orient; "
               "https://docs.baslerweb.com/stereovisard/rc_cube/en/pose_format_abb", write_abb},
    PoseFormat{"ur", kController, "m", "rad", "X Y Z RX RY RZ (URScript; PolyScope shows X Y Z in mm)", kVector, nullptr,
               "URScript manual, pose; https://www.universal-robots.com/manuals/EN/HTML/SW5_25_1/Content/"
               "prod-scriptmanual/all_scripts/Module_otion.htm", write_ur},
    PoseFormat{"halcon", kBase, "m", "deg", "TransX TransY TransZ RotX RotY RotZ type (0 = 'Rp+T', 'gba', 'point')",
               "R = Rx(RotX) Ry(RotY) Rz(RotZ): about x, the new y, the newest z", "at RotY = ±90 RotZ is 0",
               "https://www.mvtec.com/doc/halcon/2405/en/create_pose.html", write_halcon},
    PoseFormat{"opencv", kInverse, "m", "rad", "rvec x y z, tvec x y z", kVector, nullptr,
               "solvePnP, projectPoints: https://docs.opencv.org/4.x/d9/d0c/group__calib3d.html", write_opencv},
};
// clang-format on

const char* what_it_maps(Reference reference) {
  return reference == Reference::inverse
             ? "the inverse of T_base_sensor, as OpenCV's extrinsics are; it maps points of "
             : "maps points of ";
}

}  // namespace

std::span<const PoseFormat> pose_formats() { return kFormats; }

const PoseFormat* find_pose_format(std::string_view name) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(),
                                  [&](const PoseFormat& format) { return name == format.name; });
  return found == kFormats.end() ? nullptr : &*found;
}

std::string pose_format_names() {
  std::string names;
  for (const auto& format : kFormats) names += std::string(names.empty() ? "" : ", ") + format.name;
  return names;
}

std::optional<FramedPose> refer(const FramedPose& sensor_in_base, Reference reference,
                                const std::optional<ControllerFrame>& controller) {
  const auto& [T_base_sensor, base, sensor] = sensor_in_base;
  if (reference == Reference::base) return sensor_in_base;
  if (reference == Reference::inverse) return FramedPose{T_base_sensor.inverse(), sensor, base};
  if (!controller) return std::nullopt;
  return FramedPose{controller->T_base_controller.inverse() * T_base_sensor, controller->link, sensor};
}

json::object pose_members(const PoseFormat& format, const FramedPose& pose) {
  const auto& [T_to_from, to, from] = pose;
  const bool is_inverse = format.reference == Reference::inverse;
  json::object body{
      {"format", format.name},
      {"from_frame", from},
      {"to_frame", to},
      {"meaning",
       what_it_maps(format.reference) + from + " to " + to + ": p_" + to + " = R p_" + from + " + t"},
      {"inverse", is_inverse},
      {"sensor_axes", "x right, y down, z forward"},
      {"length_unit", format.length_unit},
      {"angle_unit", format.angle_unit ? json::value(format.angle_unit) : json::value(nullptr)},
      {"order", format.order},
      {"rotation", format.rotation},
      {"singularity", format.singularity ? json::value(format.singularity) : json::value(nullptr)},
      {"source", format.source}};
  format.write(body, pose);
  return body;
}

}  // namespace calibrd::api
