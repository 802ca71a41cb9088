// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/events/event_hub.hpp"

#include <algorithm>
#include <charconv>

namespace calibrd::api {

void EventHub::publish(const std::string& subject, std::string type, std::string data) {
  const std::lock_guard lock(mutex_);
  Event& newest = newest_[subject];
  if (newest.number != 0 && newest.data == data) return;
  newest = {++last_, std::move(type), std::move(data)};
  kept_.push_back(newest);
  if (kept_.size() > kKept) kept_.pop_front();
}

EventBatch EventHub::after(std::optional<std::uint64_t> number) const {
  const std::lock_guard lock(mutex_);
  EventBatch batch;
  batch.last = last_;
  const auto first_kept = kept_.empty() ? last_ + 1 : kept_.front().number;
  batch.is_whole_state = !number || *number > last_ || *number + 1 < first_kept;
  if (batch.is_whole_state) {
    for (const auto& [subject, event] : newest_) batch.events.push_back(event);
    std::ranges::sort(batch.events, {}, &Event::number);
  } else {
    const auto from = std::ranges::upper_bound(kept_, *number, {}, &Event::number);
    batch.events.assign(from, kept_.end());
  }
  return batch;
}

std::optional<std::uint64_t> EventHub::number_of(std::string_view id) const {
  if (!id.starts_with(run_) || id.size() <= run_.size() + 1 || id[run_.size()] != '-') return std::nullopt;
  std::uint64_t number = 0;
  const auto* const end = id.data() + id.size();
  const auto [rest, failure] = std::from_chars(id.data() + run_.size() + 1, end, number);
  if (failure != std::errc() || rest != end) return std::nullopt;
  return number;
}

}  // namespace calibrd::api
