// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/collector/inbox.hpp"

namespace calibrd::fleet {

void Inbox::put(Arrival arrival) {
  const std::lock_guard lock(mutex_);
  const auto size = arrival.document.size();
  if (waiting_.size() >= capacity_ || bytes_ + size > most_bytes_) return;
  auto& document = waiting_[{std::move(arrival.cell), std::move(arrival.calibration_id)}];
  bytes_ += size - document.size();
  document = std::move(arrival.document);
  change_.notify_one();
}

std::vector<Arrival> Inbox::take(std::size_t most, std::size_t bytes, std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  change_.wait_for(lock, patience, [this] { return !waiting_.empty(); });
  std::vector<Arrival> taken;
  std::size_t size = 0;
  while (taken.size() < most && !waiting_.empty()) {
    size += waiting_.begin()->second.size();
    if (!taken.empty() && size > bytes) break;
    auto row = waiting_.extract(waiting_.begin());
    bytes_ -= row.mapped().size();
    taken.push_back({row.key().first, row.key().second, std::move(row.mapped())});
  }
  return taken;
}

std::size_t Inbox::size() const {
  const std::lock_guard lock(mutex_);
  return waiting_.size();
}

}  // namespace calibrd::fleet
