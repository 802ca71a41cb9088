// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>

#include "api/events/event_hub.hpp"
#include "api/service/cell_service.hpp"

namespace calibrd::api {

/// Tells an EventHub what has changed in the cell: it looks at the same reports as every other client, so
/// that events and answers cannot contradict each other. One thread at a time.
class StateFeed {
 public:
  /// Both must outlive it.
  StateFeed(CellService& service, EventHub& hub) : service_(service), hub_(hub) {}

  /// To be called some times a second.
  void look();

 private:
  void look_at_calibrations(const SensorReport& sensor);
  void tell(const std::string& sensor_id, const std::string& calibration_id);

  CellService& service_;
  EventHub& hub_;
  std::map<std::string, std::string> ended_;  // calibration last told to have ended, by sensor
};

}  // namespace calibrd::api
