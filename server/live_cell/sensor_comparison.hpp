// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "api/service/cell_reports.hpp"
#include "core/cross_check/cross_check.hpp"
#include "server/live_cell/calibration_jobs.hpp"

namespace calibrd {

// Compares sensors by what they see of the cell itself. Safe to call from any thread.

/// All pairs.
std::vector<api::SensorPair> compare_pairs(std::span<const LiveSensor* const> sensors);

/// Compares a result that was just accepted, and the background its views show, with every sensor whose
/// pose is valid. Where they disagree it gets a reason, and the weaker of the two is not to be trusted:
/// `result` becomes uncertain, or an objection is returned, which counts once the result is served. `others`:
/// without the sensor itself.
std::vector<Objection> review_against(std::span<LiveSensor* const> others, const LiveSensor& sensor,
                                      const BackgroundMap& background, CalibrationResult& result);

}  // namespace calibrd
