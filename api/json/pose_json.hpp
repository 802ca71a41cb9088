// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/json/array.hpp>

#include "core/geometry/pose.hpp"

namespace calibrd::api {

/// 4x4, row-major, nested by rows.
boost::json::array matrix_json(const Pose& pose);
/// [x, y, z], m.
boost::json::array translation_json(const Pose& pose);
/// [x, y, z, w], the canonical_quaternion().
boost::json::array rotation_xyzw_json(const Pose& pose);

}  // namespace calibrd::api
