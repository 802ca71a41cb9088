// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/sensor_comparison.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "core/calibration/check_pose.hpp"

namespace calibrd {
namespace {

struct Known {
  std::shared_ptr<const BackgroundMap> background;
  api::PoseReport pose;  ///< valid
};

std::optional<Known> known_now(const LiveSensor& sensor) {
  Known known{sensor.background(), sensor.pose()};
  // Once more: another pose that took over meanwhile has no background yet.
  if (!known.background || !known.pose.valid || sensor.background() != known.background) return std::nullopt;
  return known;
}

CheckedSensor checked(const Known& known) {
  const auto& result = known.pose.known->result;
  return {*known.background, *result.T_base_sensor, result.covariance, result.depth_correction};
}

/// How well a pose puts `point_base` in its place, m².
double variance_at(const CheckedSensor& sensor, const Eigen::Vector3d& point_base) {
  const Matrix6d move = shift_of_point(point_base - sensor.T_base_sensor.translation());
  return (move * sensor.covariance * move.transpose()).bottomRightCorner<3, 3>().trace();
}

std::string disagreement(const CrossCheck& check, const std::string& sensor, const std::string& other) {
  std::array<char, 200> figures{};
  if (std::isfinite(check.sigmas))
    std::snprintf(figures.data(), figures.size(), "%.1f mm and %.1f mrad apart, %.1f standard deviations",
                  1e3 * check.shift_m, 1e3 * check.turn_rad, check.sigmas);
  else
    std::snprintf(figures.data(), figures.size(), "nothing near makes them fit");
  return "what \"" + sensor + "\" and \"" + other +
         "\" both see of the cell does not lie at the same place (" + figures.data() +
         "): one of the poses is wrong, or much was moved between their calibrations; calibrate both from "
         "the same postures";
}

}  // namespace

std::vector<api::SensorPair> compare_pairs(std::span<const LiveSensor* const> sensors) {
  std::vector<api::SensorPair> pairs;
  for (std::size_t i = 0; i < sensors.size(); ++i)
    for (std::size_t j = i + 1; j < sensors.size(); ++j) {
      api::SensorPair pair{sensors[i]->id(), sensors[j]->id(), false, {}};
      const auto first = known_now(*sensors[i]), second = known_now(*sensors[j]);
      pair.compared = first && second;
      if (pair.compared) pair.check = cross_check(checked(*first), checked(*second));
      pairs.push_back(std::move(pair));
    }
  return pairs;
}

std::vector<Objection> review_against(std::span<LiveSensor* const> others, const LiveSensor& sensor,
                                      const BackgroundMap& background, CalibrationResult& result) {
  std::vector<Objection> objections;
  for (LiveSensor* other : others) {
    const auto known = known_now(*other);
    if (!known) continue;
    const CheckedSensor mine{background, *result.T_base_sensor, result.covariance, result.depth_correction};
    const CrossCheck check = cross_check(checked(*known), mine);
    if (!check.disagrees()) continue;
    const auto text = disagreement(check, sensor.id(), other->id());
    result.reasons.push_back({"sensors_disagree", text});
    if (variance_at(mine, check.middle_base) >= variance_at(checked(*known), check.middle_base))
      result.verdict = Verdict::uncertain;
    else
      objections.push_back({other, known->pose.known->calibration_id, text});
  }
  // Who is not sure of himself does not accuse.
  if (result.verdict != Verdict::accepted) objections.clear();
  return objections;
}

}  // namespace calibrd
