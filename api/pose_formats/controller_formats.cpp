// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <boost/json/array.hpp>
#include <numbers>

#include "api/json/pose_json.hpp"
#include "api/pose_formats/euler_angles.hpp"
#include "api/pose_formats/pose_text.hpp"
#include "api/pose_formats/writers.hpp"
#include "core/geometry/canonical_rotation.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

constexpr double kMmPerM = 1000;
constexpr double kDegPerRad = 180 / std::numbers::pi;

/// What most controllers show: position, mm, and angles about z, y and x, deg: R = Rz(z) Ry(y) Rx(x). Makes
/// differ in how they call the angles and in which order they write them.
struct CartesianNumbers {
  Eigen::Vector3d position_mm;
  double about_z_deg, about_y_deg, about_x_deg;
};

CartesianNumbers cartesian_numbers(const FramedPose& pose) {
  const auto [z, y, x] = zyx_angles(pose.T_to_from.linear());
  return {kMmPerM * pose.T_to_from.translation(), z * kDegPerRad, y * kDegPerRad, x * kDegPerRad};
}

void write_position(json::object& body, const Eigen::Vector3d& position_mm) {
  body["X_mm"] = position_mm.x();
  body["Y_mm"] = position_mm.y();
  body["Z_mm"] = position_mm.z();
}

void write_angles(json::object& body, std::array<const char*, 3> names, std::array<double, 3> values) {
  for (std::size_t i = 0; i < names.size(); ++i) body[names[i]] = values[i];
}

}  // namespace

void write_kuka(json::object& body, const FramedPose& pose) {
  const auto [p, z, y, x] = cartesian_numbers(pose);
  write_position(body, p);
  write_angles(body, {"A_deg", "B_deg", "C_deg"}, {z, y, x});
  body["text"] = "{X " + decimals(p.x()) + ",Y " + decimals(p.y()) + ",Z " + decimals(p.z()) + ",A " +
                 decimals(z) + ",B " + decimals(y) + ",C " + decimals(x) + "}";
}

void write_fanuc(json::object& body, const FramedPose& pose) {
  const auto [p, z, y, x] = cartesian_numbers(pose);
  write_position(body, p);
  write_angles(body, {"W_deg", "P_deg", "R_deg"}, {x, y, z});
}

void write_yaskawa(json::object& body, const FramedPose& pose) {
  const auto [p, z, y, x] = cartesian_numbers(pose);
  write_position(body, p);
  write_angles(body, {"Rx_deg", "Ry_deg", "Rz_deg"}, {x, y, z});
}

void write_mitsubishi(json::object& body, const FramedPose& pose) {
  const auto [p, z, y, x] = cartesian_numbers(pose);
  write_position(body, p);
  write_angles(body, {"A_deg", "B_deg", "C_deg"}, {x, y, z});
  body["text"] = std::string("(").append(decimal_list({p.x(), p.y(), p.z(), x, y, z}, ",")).append(")(0,0)");
}

void write_kawasaki(json::object& body, const FramedPose& pose) {
  const Eigen::Vector3d p = kMmPerM * pose.T_to_from.translation();
  const auto [first, second, third] = zyz_angles(pose.T_to_from.linear());
  const double o = first * kDegPerRad, a = second * kDegPerRad, t = third * kDegPerRad;
  write_position(body, p);
  write_angles(body, {"O_deg", "A_deg", "T_deg"}, {o, a, t});
  body["text"] = "TRANS(" + decimal_list({p.x(), p.y(), p.z(), o, a, t}, ",") + ")";
}

void write_abb(json::object& body, const FramedPose& pose) {
  const Eigen::Vector3d p = kMmPerM * pose.T_to_from.translation();
  const auto q = canonical_quaternion(pose.T_to_from.linear());
  body["trans_mm"] = json::array{p.x(), p.y(), p.z()};
  body["rot_wxyz"] = json::array{q.w(), q.x(), q.y(), q.z()};
  body["text"] = "[[" + decimal_list({p.x(), p.y(), p.z()}, ",") + "],[" +
                 decimal_list({q.w(), q.x(), q.y(), q.z()}, ",") + "]]";
}

void write_ur(json::object& body, const FramedPose& pose) {
  const auto& t = pose.T_to_from.translation();
  const auto r = canonical_rotation_vector(pose.T_to_from.linear());
  body["pose"] = json::array{t.x(), t.y(), t.z(), r.x(), r.y(), r.z()};
  body["text"] = "p[" + decimal_list({t.x(), t.y(), t.z(), r.x(), r.y(), r.z()}, ", ") + "]";
}

}  // namespace calibrd::api
