// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/metrics/calibration_metrics.hpp"

namespace calibrd::api {
namespace {

/// Place in kResults.
std::size_t result_of(const CalibrationReport& calibration) {
  if (calibration.status == JobStatus::succeeded) return 0;
  if (calibration.status == JobStatus::cancelled) return 4;
  if (!calibration.result) return 3;
  return calibration.result->verdict == Verdict::uncertain ? 1 : 2;
}

}  // namespace

CalibrationMetrics::CalibrationMetrics(const std::vector<std::string>& sensor_ids) {
  for (const auto& id : sensor_ids) sensors_[id];
}

void CalibrationMetrics::note(const CalibrationReport& calibration) {
  const auto found = sensors_.find(calibration.sensor_id);
  if (found == sensors_.end() || !calibration.finished) return;
  found->second.by_result[result_of(calibration)].add();
  found->second.duration.add(Seconds(*calibration.finished - calibration.created).count());
}

void CalibrationMetrics::write(MetricsText& text) const {
  text.begin("calibrd_calibrations_total");
  for (const auto& [id, figures] : sensors_)
    for (std::size_t i = 0; i < kResults.size(); ++i)
      text.add({{"sensor", id}, {"result", kResults[i]}}, static_cast<double>(figures.by_result[i].value()));
  text.begin("calibrd_calibration_duration_seconds");
  for (const auto& [id, figures] : sensors_) text.add({{"sensor", id}}, figures.duration);
}

}  // namespace calibrd::api
