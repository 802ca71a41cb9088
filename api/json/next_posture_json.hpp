// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/json/object.hpp>
#include <optional>
#include <string>

#include "core/calibration/calibrate.hpp"
#include "core/planning/next_posture.hpp"

namespace calibrd::api {

/// The object `next_posture` of docs/calibration.md.
boost::json::object next_posture_object(const PostureSuggestion& suggestion);

/// What `calibrd calibrate --suggest` prints: calibration_result_json() with `next_posture`, null where there
/// is none.
std::string calibration_and_next_posture_json(const CalibrationResult& result, double load_ms,
                                              const std::optional<PostureSuggestion>& suggestion);

}  // namespace calibrd::api
