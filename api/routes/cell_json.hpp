// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/json/object.hpp>

#include "api/service/reports.hpp"

namespace calibrd::api {

boost::json::object sensor_json(const SensorReport& sensor);
boost::json::object robot_json(const RobotReport& robot);
/// What changes many times a second, and no more.
boost::json::object live_joints_json(const RobotReport& robot);
/// `with_result`: also the whole result; histories leave it out.
boost::json::object calibration_json(const CalibrationReport& calibration, bool with_result);

}  // namespace calibrd::api
