// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/json/object.hpp>

#include "core/calibration/calibrate.hpp"

namespace calibrd::api {

/// See calibration_result_json().
boost::json::object calibration_result_object(const CalibrationResult& result);

}  // namespace calibrd::api
