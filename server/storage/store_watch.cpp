// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/store_watch.hpp"

#include <utility>

namespace calibrd {

StoreWatch::StoreWatch(CalibrationStore& store, std::function<void(const api::StorageReport&)> on_change,
                       std::function<void()> on_look, std::chrono::milliseconds period)
    : store_(store),
      on_change_(std::move(on_change)),
      on_look_(std::move(on_look)),
      thread_([this, period] { run(period); }) {}

StoreWatch::~StoreWatch() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

void StoreWatch::run(std::chrono::milliseconds period) {
  api::StorageReport told;
  std::unique_lock lock(mutex_);
  while (!is_stopping_) {
    lock.unlock();
    // What a failure since the last look said is told before the look may have mended it.
    for (const bool looks : {false, true}) {
      if (looks) store_.look();
      if (auto report = store_.report(); report.state != told.state) {
        on_change_(report);
        told = std::move(report);
      }
    }
    if (on_look_) on_look_();
    lock.lock();
    changed_.wait_for(lock, period, [this] { return is_stopping_; });
  }
}

}  // namespace calibrd
