// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/frame_numbering.hpp"

namespace calibrd {
namespace {

// A longer jump is a device that numbers anew: the daemon restarts a sensor long before it lost so many
// frames.
constexpr std::int64_t kLongestGap = 1000;

bool is_repeat(const Moment& last, const Moment& now) {
  const bool is_numbered = now.index != 0 || now.timestamp_us != 0;
  return is_numbered && now.index == last.index && now.timestamp_us == last.timestamp_us;
}

}  // namespace

std::optional<std::uint64_t> FrameNumbering::number(const Moment& moment) {
  if (last_) {
    if (is_repeat(*last_, moment)) return std::nullopt;
    const std::int64_t gap = std::int64_t{moment.index} - last_->index;
    number_ += gap >= 1 && gap <= kLongestGap ? static_cast<std::uint64_t>(gap) : 1;
  }
  last_ = moment;
  return number_;
}

}  // namespace calibrd
