// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/collector/inbox.hpp"

namespace calibrd::fleet {

void Inbox::put(Arrival arrival) {
  const std::lock_guard lock(mutex_);
  if (waiting_.size() >= capacity_) return;
  waiting_.insert_or_assign({std::move(arrival.cell), std::move(arrival.calibration_id)}, std::move(arrival.document));
  change_.notify_one();
}

std::vector<Arrival> Inbox::take(std::size_t most, std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  change_.wait_for(lock, patience, [this] { return !waiting_.empty(); });
  std::vector<Arrival> taken;
  while (taken.size() < most && !waiting_.empty()) {
    auto row = waiting_.extract(waiting_.begin());
    taken.push_back({row.key().first, row.key().second, std::move(row.mapped())});
  }
  return taken;
}

std::size_t Inbox::size() const {
  const std::lock_guard lock(mutex_);
  return waiting_.size();
}

}  // namespace calibrd::fleet
