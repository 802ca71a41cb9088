// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/section_declarer.hpp"

namespace calibrd {

using namespace std::chrono_literals;

void declare_drift(std::vector<Setting>& table) {
  SectionDeclarer<DriftConfig> key(table, {"drift"},
                                   [](Config& c, const Names&) -> DriftConfig& { return c.drift; });
  key("tolerance_mm", &DriftConfig::tolerance_mm, real(0.05, 2), "mm",
      "A sensor that has moved what it sees by less stands.");
  key("tolerance_mrad", &DriftConfig::tolerance_mrad, real(0.05, 2), "mrad",
      "A sensor that has turned by less stands.");
  key("false_alarms_per_year", &DriftConfig::false_alarms_per_year, real(1e-6, 1000), "",
      "How often a sensor that stands may be taken for moved; sets the threshold of the test.");
  key("depth_bias_mm", &DriftConfig::depth_bias_mm, real(0.1, 1000), "mm",
      "A range that reads otherwise than at calibration by more is reported.");
  key("absorb_after", &DriftConfig::absorb_after, duration(5s, 24h), "",
      "What was moved, brought or taken away belongs to the background after this time.");
  key("healing", &DriftConfig::healing, one_of({"automatic", "ask", "off"}), "",
      "When a sensor has moved: calibrate and use the result, calibrate and wait for activate, or do "
      "nothing.");
  key("healing_postures", &DriftConfig::healing_postures, integer(1, 50), "",
      "Postures of the first two, quick attempts, at most. Later ones collect calibration.postures.");
  key("healing_patience", &DriftConfig::healing_patience, duration(0ms, 10min), "",
      "A quick attempt begins after this time with the postures there are, if there are two; with one after "
      "two and a half times as long.");
  key("healing_cooldown", &DriftConfig::healing_cooldown, duration(100ms, 24h), "",
      "Pause after failed attempts, before a quick result is made better, and for a sensor that moves for "
      "the fifth time within ten minutes; doubles from one to the next up to ten minutes.");
}

}  // namespace calibrd
