// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <span>

#include "api/service/cell_reports.hpp"
#include "core/cross_check/cross_check.hpp"
#include "server/live_cell/live_sensor.hpp"

namespace calibrd {

/// Compares sensors by what they see of the cell itself. Safe to call from any thread.
class SensorComparison {
 public:
  /// `cell` and its robot must outlive it.
  explicit SensorComparison(const VirtualCell& cell) : cell_(cell) {}

  /// All pairs.
  std::vector<api::SensorPair> pairs(std::span<const LiveSensor* const> sensors) const;

  /// Called for a sensor whose served pose is the weaker one of two that disagree, with the reason.
  using Distrust = std::function<void(LiveSensor&, const std::string& reason)>;
  /// Compares a result that was just found, from these views, with every sensor whose pose is valid. Where
  /// they disagree it gets a reason, and the weaker of the two is not trusted: `result` becomes uncertain, or
  /// `distrust` is called. `others`: without the sensor itself.
  void review(const LiveSensor& sensor, std::span<const View> views, std::span<LiveSensor* const> others,
              CalibrationResult& result, const Distrust& distrust) const;

 private:
  BackgroundMap background_of(const CameraModel& camera, std::span<const View> views,
                              const Pose& T_base_sensor) const;

  const VirtualCell& cell_;
};

}  // namespace calibrd
