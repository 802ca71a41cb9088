// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>

#include "server/live_cell/posture_collector.hpp"

namespace calibrd {

/// Postures being collected from one sensor: fed by the sensor's thread, watched and ended by others.
/// Safe to call from any thread.
class CollectTask {
 public:
  /// `on_complete` is called once, `on_dropped` whenever start_over() has dropped postures; both on the
  /// feeding thread.
  explicit CollectTask(const CollectorSettings& settings, std::function<void()> on_complete = {},
                       std::function<void()> on_dropped = {})
      : collector_(settings), on_complete_(std::move(on_complete)), on_dropped_(std::move(on_dropped)) {}

  void offer(const View& view);
  void interrupt();
  /// The sensor was lost or has moved: views of before and after it never come together. A complete task
  /// keeps its own.
  void start_over();
  void cancel();
  /// What has been seen is enough, once that are `least` postures: the task is complete.
  void settle_for_less(int least);

  bool is_open() const;  ///< neither complete nor cancelled: wants more views
  bool is_complete() const;
  bool is_waiting_for_motion() const;
  int seen() const;
  int dropped() const;    ///< postures that start_over() has dropped
  int most_seen() const;  ///< never fewer than before

  /// Waits for the end. True: complete; false: cancelled, or the deadline has come.
  bool wait_until(Clock::time_point deadline);

  std::vector<View> take_views();

 private:
  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable ended_;
  PostureCollector collector_;
  std::function<void()> on_complete_;
  const std::function<void()> on_dropped_;
  int dropped_ = 0, most_seen_ = 0;
  bool is_cancelled_ = false;
};

/// "; 2 more …" for a message that tells how many were seen; empty: none were dropped.
std::string dropped_postures(const CollectTask& task);

}  // namespace calibrd
