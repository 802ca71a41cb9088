// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/collect_task.hpp"

#include <algorithm>

namespace calibrd {

void CollectTask::offer(const View& view) {
  std::function<void()> tell;
  {
    const std::lock_guard lock(mutex_);
    if (is_cancelled_ || collector_.is_complete()) return;
    collector_.offer(view);
    most_seen_ = std::max(most_seen_, collector_.seen());
    if (!collector_.is_complete()) return;
    tell = std::move(on_complete_);
    ended_.notify_all();
  }
  if (tell) tell();
}

void CollectTask::interrupt() {
  const std::lock_guard lock(mutex_);
  collector_.interrupt();
}

void CollectTask::start_over() {
  int dropped = 0;
  {
    const std::lock_guard lock(mutex_);
    if (is_cancelled_ || collector_.is_complete()) return;
    dropped = collector_.seen();
    dropped_ += dropped;
    collector_.start_over();
  }
  if (dropped > 0 && on_dropped_) on_dropped_();
}

void CollectTask::cancel() {
  const std::lock_guard lock(mutex_);
  is_cancelled_ = true;
  ended_.notify_all();
}

void CollectTask::settle_for_less(int least) {
  const std::lock_guard lock(mutex_);
  if (is_cancelled_) return;
  collector_.settle_for_less(least);
  if (collector_.is_complete()) ended_.notify_all();
}

bool CollectTask::is_open() const {
  const std::lock_guard lock(mutex_);
  return !is_cancelled_ && !collector_.is_complete();
}

bool CollectTask::is_complete() const {
  const std::lock_guard lock(mutex_);
  return collector_.is_complete();
}

bool CollectTask::is_waiting_for_motion() const {
  const std::lock_guard lock(mutex_);
  return collector_.is_waiting_for_motion();
}

int CollectTask::seen() const {
  const std::lock_guard lock(mutex_);
  return collector_.seen();
}

int CollectTask::most_seen() const {
  const std::lock_guard lock(mutex_);
  return most_seen_;
}

int CollectTask::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

bool CollectTask::wait_until(Clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  ended_.wait_until(lock, deadline, [this] { return is_cancelled_ || collector_.is_complete(); });
  return collector_.is_complete() && !is_cancelled_;
}

std::vector<View> CollectTask::take_views() {
  const std::lock_guard lock(mutex_);
  return collector_.take_views();
}

std::string dropped_postures(const CollectTask& task) {
  const int dropped = task.dropped();
  if (dropped == 0) return {};
  return "; " + std::to_string(dropped) +
         " more dropped when the sensor was lost or had moved: views of before and after never come together";
}

}  // namespace calibrd
