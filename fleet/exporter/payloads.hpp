// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <string>

#include "api/service/reports.hpp"

namespace calibrd::fleet {

/// JSON, UTF-8, one object each: docs/fleet.md. Times are RFC 3339, UTC.
/// Who tells a status: cell, version and run of the daemon.
struct Teller {
  std::string cell, version, instance;
};
/// `since`: nothing where nobody knows when it began, as in a last will.
std::string status_payload(const Teller& teller, bool online, std::optional<api::SystemTime> since);

/// So long a message is kept that holds only while the daemon lives, at most: six tellings.
constexpr std::chrono::seconds kKept{60};

/// `valid_until` is left out where it is not valid; T_base_sensor too. `with_end`: false leaves it out
/// always, for comparing.
std::string pose_payload(const std::string& cell, const api::PoseReport& pose, api::SystemTime now,
                         bool with_end = true);

/// Nothing in it changes from frame to frame.
std::string state_payload(const std::string& cell, const api::SensorReport& sensor,
                          const api::PoseReport& pose, const api::DriftReport& drift);

std::string calibration_payload(const std::string& cell, const api::CalibrationReport& calibration);

/// How much longer a valid pose may be used by who hears no more of it: until the next check is due, kKept at
/// most.
api::Seconds rest_of_validity(const api::PoseReport& pose);

}  // namespace calibrd::fleet
