// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
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

constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

json::array vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

void write_matrix(json::object& body, const FramedPose& pose) {
  body["T_base_sensor"] = matrix_json(pose.T_to_from);
}

void write_quaternion(json::object& body, const FramedPose& pose) {
  body["translation_m"] = translation_json(pose.T_to_from);
  body["rotation_xyzw"] = rotation_xyzw_json(pose.T_to_from);
}

void write_rotvec(json::object& body, const FramedPose& pose) {
  body["translation_m"] = translation_json(pose.T_to_from);
  body["rotation_vector_rad"] = vector_json(canonical_rotation_vector(pose.T_to_from.linear()));
}

void write_halcon(json::object& body, const FramedPose& pose) {
  const auto& t = pose.T_to_from.translation();
  const auto [x, y, z] = xyz_angles(pose.T_to_from.linear());
  const double rx = x * kDegreesPerRadian, ry = y * kDegreesPerRadian, rz = z * kDegreesPerRadian;
  constexpr int kRpPlusT_gba_point = 0;
  body["pose"] = json::array{t.x(), t.y(), t.z(), rx, ry, rz, kRpPlusT_gba_point};
  body["text"] = "create_pose (" + decimal_list({t.x(), t.y(), t.z(), rx, ry, rz}, ", ") +
                 ", 'Rp+T', 'gba', 'point', CamInBasePose)";
}

void write_opencv(json::object& body, const FramedPose& pose) {
  body["rvec_rad"] = vector_json(canonical_rotation_vector(pose.T_to_from.linear()));
  body["tvec_m"] = translation_json(pose.T_to_from);
}

}  // namespace calibrd::api
