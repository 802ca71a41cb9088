// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "core/base/result.hpp"
#include "core/calibration/calibrate.hpp"

namespace calibrd::api {

/// The JSON object that `calibrd calibrate` prints and every calibration of the HTTP interface holds as
/// `result`. A rejected result has no T_base_sensor. `load_ms`: time for reading files, where there was any.
std::string calibration_result_json(const CalibrationResult& result,
                                    std::optional<double> load_ms = std::nullopt);

/// Reads back what calibration_result_json() wrote. Error: ApiError::bad_json or bad_value, naming the key.
Result<CalibrationResult> parse_calibration_result(const std::string& text);

const char* name_of(Verdict verdict);
const char* name_of(Method method);

}  // namespace calibrd::api
