// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "core/base/heartbeat.hpp"

namespace calibrd {

/// A thread that must go on makes no progress for this long: it hangs.
inline constexpr auto kStalledAfter = std::chrono::seconds(10);

/// The heartbeats of the threads that must go on, by name. Filled before anybody looks; then safe from any
/// thread. Threads that wait for the disk or compute a calibration are none of them: a restart makes neither
/// faster.
class Pulse {
 public:
  /// `heartbeat` must outlive the looks.
  void add(const std::string& thread, const Heartbeat& heartbeat) { threads_[thread] = &heartbeat; }

  /// Threads whose last beat is longer ago; those that never beat have not begun.
  std::vector<std::string> stalled(std::chrono::nanoseconds limit = kStalledAfter) const {
    std::vector<std::string> names;
    for (const auto& [name, heartbeat] : threads_)
      if (const auto age = heartbeat->age(); age && *age > limit) names.push_back(name);
    return names;
  }

  const std::map<std::string, const Heartbeat*>& threads() const { return threads_; }

 private:
  std::map<std::string, const Heartbeat*> threads_;
};

}  // namespace calibrd
