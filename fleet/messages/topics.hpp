// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace calibrd::fleet {

/// Letters, digits, '.', '_' and '-', 1 to 64 of them: what a level of a topic of ours may be.
bool is_name(std::string_view text);

/// The topics of one cell: PREFIX/v1/cells/CELL/...
class CellTopics {
 public:
  CellTopics(const std::string& prefix, const std::string& cell);

  std::string status() const { return base_ + "status"; }              ///< retained; also the last will
  std::string calibrations() const { return base_ + "calibrations"; }  ///< each until it is acknowledged
  std::string acknowledgements() const { return base_ + "acknowledgements"; }  ///< by the collector
  std::string pose(const std::string& sensor) const {
    return base_ + "sensors/" + sensor + "/pose";
  }  ///< retained
  std::string state(const std::string& sensor) const {
    return base_ + "sensors/" + sensor + "/state";
  }  ///< retained

 private:
  std::string base_;
};

/// Where a collector says that it has started or come back (retained).
std::string collector_topic(const std::string& prefix);

/// The calibrations of every cell, to subscribe to.
std::string every_calibration(const std::string& prefix);

/// The cell of a topic that every_calibration() matches.
std::optional<std::string> cell_of(const std::string& prefix, std::string_view topic);

}  // namespace calibrd::fleet
