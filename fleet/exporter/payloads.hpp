// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "api/service/reports.hpp"

namespace calibrd::fleet {

/// JSON, UTF-8, one object each: docs/fleet.md. Times are RFC 3339, UTC.
std::string status_payload(const std::string& cell, bool online, const std::string& version, api::SystemTime now);

/// `valid_until` is left out where it is not valid; T_base_sensor too. `with_end`: false leaves it out always, for
/// comparing.
std::string pose_payload(const std::string& cell, const api::PoseReport& pose, api::SystemTime now, bool with_end = true);

/// Nothing in it changes from frame to frame.
std::string state_payload(const std::string& cell, const api::SensorReport& sensor, const api::PoseReport& pose,
                          const api::DriftReport& drift);

std::string calibration_payload(const std::string& cell, const api::CalibrationReport& calibration);

/// How much longer a valid pose may be used without another check.
api::Seconds rest_of_validity(const api::PoseReport& pose);

}  // namespace calibrd::fleet
