// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <mutex>
#include <span>

#include "api/service/cell_reports.hpp"
#include "core/virtual_cell/virtual_cell.hpp"
#include "server/live_cell/live_sensor.hpp"

namespace calibrd {

/// Makes one cloud of what all sensors with valid poses measure. Nothing is computed until one is asked for.
/// Safe to call from any thread; one cloud at a time.
class CloudMerger {
 public:
  explicit CloudMerger(const VirtualCell& cell) : cell_(cell) {}

  /// Error: that of the first sensor when none can contribute.
  Result<api::MergedCloud> merge(std::span<const LiveSensor* const> sensors,
                                 const api::MergedCloudRequest& request);

 private:
  api::MergedCloud::Part add(const LiveSensor& sensor, const Sighting& sighting,
                             const api::PoseReport::Known& known, bool with_robot,
                             std::vector<Eigen::Vector3f>& points);

  std::mutex mutex_;  // guards cell_
  VirtualCell cell_;
};

}  // namespace calibrd
