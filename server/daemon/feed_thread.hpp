// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <mutex>
#include <thread>

#include "api/feed/state_feed.hpp"

namespace calibrd {

/// Has a StateFeed look at the cell ten times a second, on a thread of its own: the end of a calibration is
/// read from the disk.
class FeedThread {
 public:
  /// `service` must outlive it.
  explicit FeedThread(api::CellService& service);
  ~FeedThread();

  /// Safe to use from any thread, as long as this lives.
  const api::EventHub& hub() const { return hub_; }

 private:
  void run();

  api::EventHub hub_;
  api::StateFeed feed_;
  std::mutex mutex_;
  std::condition_variable ending_;
  bool is_ending_ = false;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace calibrd
