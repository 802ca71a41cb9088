// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/json/object.hpp>

#include "core/geometry/camera_model.hpp"

namespace calibrd::api {

boost::json::object camera_json(const CameraModel& camera);

}  // namespace calibrd::api
