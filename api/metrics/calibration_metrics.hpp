// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <map>
#include <string>
#include <vector>

#include "api/metrics/metric.hpp"
#include "api/metrics/metrics_text.hpp"
#include "api/service/reports.hpp"

namespace calibrd::api {

/// How calibrations ended and how long they took, by sensor. Safe to use from any thread.
class CalibrationMetrics {
 public:
  explicit CalibrationMetrics(const std::vector<std::string>& sensor_ids);

  /// Counts a calibration that has ended; any other is left alone.
  void note(const CalibrationReport& calibration);

  void write(MetricsText& text) const;

 private:
  static constexpr std::array kResults{"succeeded", "uncertain", "rejected", "failed", "cancelled"};
  static constexpr std::array kBounds_s{1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1800.0};
  struct Figures {
    std::array<Counter, kResults.size()> by_result;
    Histogram<kBounds_s.size()> duration{kBounds_s};
  };
  std::map<std::string, Figures, std::less<>> sensors_;  // fixed once made
};

}  // namespace calibrd::api
