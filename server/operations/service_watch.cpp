// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/service_watch.hpp"

#include <algorithm>

#include "core/base/thread_name.hpp"
#include "server/operations/pulse.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;

/// A watchdog that is shorter than our own idea of a stall must see one in time; a second is what a loaded
/// machine may take.
std::chrono::nanoseconds limit_for(const std::optional<std::chrono::microseconds>& watchdog) {
  if (!watchdog) return kStalledAfter;
  return std::clamp<std::chrono::nanoseconds>(*watchdog / 2, 1s, kStalledAfter);
}

/// Often enough that a ping which comes late does no harm.
std::chrono::nanoseconds period_for(const std::optional<std::chrono::microseconds>& watchdog) {
  return watchdog ? std::clamp<std::chrono::nanoseconds>(*watchdog / 4, 10ms, 1s) : 1s;
}

}  // namespace

ServiceWatch::ServiceWatch(const NotifySocket* socket, std::optional<std::chrono::microseconds> watchdog,
                           ServiceView view)
    : socket_(socket),
      pings_(watchdog.has_value()),
      limit_(limit_for(watchdog)),
      period_(period_for(watchdog)),
      view_(std::move(view)),
      thread_([this] { run(); }) {}

ServiceWatch::~ServiceWatch() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  ending_.notify_all();
  thread_.join();
}

void ServiceWatch::run() {
  name_thread("service watch");
  std::unique_lock lock(mutex_);
  while (!is_ending_) {
    lock.unlock();
    look();
    lock.lock();
    ending_.wait_for(lock, period_, [this] { return is_ending_; });
  }
}

void ServiceWatch::look() {
  auto stalled = view_.stalled(limit_);
  if (stalled.empty() && pings_) send("WATCHDOG=1");
  if (stalled != told_stalled_) view_.on_stall(stalled);
  told_stalled_ = std::move(stalled);
  if (!told_stalled_.empty()) return;  // what the status is made from may hang, too
  if (auto status = view_.status(); status != told_) {
    send("STATUS=" + status);
    told_ = std::move(status);
  }
}

}  // namespace calibrd
