// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <chrono>
#include <optional>

namespace calibrd {

/// Shows that a thread goes on: the thread beats, others look how long ago that was. Safe to use from any
/// thread.
class Heartbeat {
 public:
  using Time = std::chrono::steady_clock;

  void beat() { last_.store(Time::now().time_since_epoch().count(), std::memory_order_relaxed); }

  /// Since the last beat; nothing before the first.
  std::optional<Time::duration> age() const {
    const auto last = last_.load(std::memory_order_relaxed);
    if (last == 0) return std::nullopt;
    return Time::now() - Time::time_point(Time::duration(last));
  }

 private:
  std::atomic<Time::rep> last_{0};
};

}  // namespace calibrd
