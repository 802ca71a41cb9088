// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <sstream>
#include <stdexcept>
#include <string>

#include "core/geometry/pose.hpp"
#include "core/robot/robot_model.hpp"
#include "tests/core/robot/scratch_folder.hpp"

namespace calibrd::test {

/// The robot that `links_and_joints` describes, loaded as a user's URDF is: from a file. Primitive shapes
/// only.
inline RobotModel robot_from(const std::string& links_and_joints) {
  const ScratchFolder folder;
  const auto file = folder.write("robot.urdf", "<robot name='test'>" + links_and_joints + "</robot>");
  auto robot = RobotModel::load(file);
  if (!robot) throw std::runtime_error(robot.error().message());
  return std::move(robot).value();
}

/// `<origin>` of a pose: roll, pitch and yaw about the fixed axes x, y, z.
inline std::string origin(const Pose& T_parent_shape) {
  const Eigen::Vector3d ypr = T_parent_shape.linear().eulerAngles(2, 1, 0);
  const Eigen::Vector3d t = T_parent_shape.translation();
  std::ostringstream text;
  text.precision(17);
  text << "<origin xyz='" << t.x() << ' ' << t.y() << ' ' << t.z() << "' rpy='" << ypr[2] << ' ' << ypr[1]
       << ' ' << ypr[0] << "'/>";
  return text.str();
}

inline std::string box_shape(const Eigen::Vector3d& size_m, const Pose& T_link_shape = Pose::Identity()) {
  std::ostringstream text;
  text << "<visual>" << origin(T_link_shape) << "<geometry><box size='" << size_m.x() << ' ' << size_m.y()
       << ' ' << size_m.z() << "'/></geometry></visual>";
  return text.str();
}

inline std::string sphere_shape(double radius_m) {
  return "<visual><geometry><sphere radius='" + std::to_string(radius_m) + "'/></geometry></visual>";
}

inline std::string cylinder_shape(double radius_m, double length_m,
                                  const Pose& T_link_shape = Pose::Identity()) {
  std::ostringstream text;
  text << "<visual>" << origin(T_link_shape) << "<geometry><cylinder radius='" << radius_m << "' length='"
       << length_m << "'/></geometry></visual>";
  return text.str();
}

inline std::string link(const std::string& name, const std::string& shapes = "") {
  return "<link name='" + name + "'>" + shapes + "</link>";
}

/// A joint that can turn by half a turn to both sides about `axis` ("0 0 1").
inline std::string revolute(const std::string& name, const std::string& parent, const std::string& child,
                            const std::string& axis, const Pose& T_parent_joint) {
  return "<joint name='" + name + "' type='revolute'><parent link='" + parent + "'/><child link='" + child +
         "'/><axis xyz='" + axis + "'/>" + origin(T_parent_joint) +
         "<limit lower='-3.14' upper='3.14' effort='1' velocity='1'/></joint>";
}

inline Pose shift(double x_m, double y_m, double z_m) { return Pose(Eigen::Translation3d(x_m, y_m, z_m)); }

/// A sensor at `position` whose optical axis points at `target`, the image's x axis level (base frame, z up,
/// m).
inline Pose looking_at(const Eigen::Vector3d& position, const Eigen::Vector3d& target) {
  Pose T_base_sensor = Pose::Identity();
  const Eigen::Vector3d z = (target - position).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  T_base_sensor.linear() << x, z.cross(x), z;
  T_base_sensor.translation() = position;
  return T_base_sensor;
}

}  // namespace calibrd::test
