// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/json/pose_json.hpp"

#include "core/geometry/canonical_rotation.hpp"

namespace calibrd::api {

namespace json = boost::json;

json::array matrix_json(const Pose& pose) {
  json::array rows;
  for (int r = 0; r < 4; ++r) {
    json::array row;
    for (int c = 0; c < 4; ++c) row.emplace_back(pose.matrix()(r, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

json::array translation_json(const Pose& pose) {
  const auto& t = pose.translation();
  return {t.x(), t.y(), t.z()};
}

json::array rotation_xyzw_json(const Pose& pose) {
  const auto q = canonical_quaternion(pose.linear());
  return {q.x(), q.y(), q.z(), q.w()};
}

}  // namespace calibrd::api
