// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <span>

#include "api/service/cell_reports.hpp"
#include "core/cross_check/cross_check.hpp"
#include "server/live_cell/live_sensor.hpp"

namespace calibrd {

// Compares sensors by what they see of the cell itself. Safe to call from any thread.

/// All pairs.
std::vector<api::SensorPair> compare_pairs(std::span<const LiveSensor* const> sensors);

/// Called for a sensor whose served pose is the weaker one of two that disagree, with the reason.
using Distrust = std::function<void(LiveSensor&, const std::string& reason)>;
/// Compares a result that was just accepted, and the background its views show, with every sensor whose
/// pose is valid. Where they disagree it gets a reason, and the weaker of the two is not trusted: `result`
/// becomes uncertain, or `distrust` is called. `others`: without the sensor itself.
void review_against(std::span<LiveSensor* const> others, const LiveSensor& sensor,
                    const BackgroundMap& background, CalibrationResult& result, const Distrust& distrust);

}  // namespace calibrd
