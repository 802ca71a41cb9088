// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "server/storage/calibration_store.hpp"

namespace calibrd {

/// Looks after a store: what failed is tried again, the first time at once. A thread of its own.
class StoreWatch {
 public:
  /// `store` must outlive it. `on_change` hears, on the thread, of every other state than "good" at first,
  /// and of every change from then on. `on_look` is called with every look.
  StoreWatch(CalibrationStore& store, std::function<void(const api::StorageReport&)> on_change,
             std::function<void()> on_look = {}, std::chrono::milliseconds period = std::chrono::seconds(2));
  ~StoreWatch();

 private:
  void run(std::chrono::milliseconds period);

  CalibrationStore& store_;
  const std::function<void(const api::StorageReport&)> on_change_;
  const std::function<void()> on_look_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_stopping_ = false;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace calibrd
