// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/frame_cadence.hpp"

#include <algorithm>
#include <vector>

namespace calibrd {
namespace {

constexpr std::size_t kKept = 32;  // more than ever wait for joints
constexpr std::ptrdiff_t kReach = 5;

}  // namespace

void FrameCadence::add(std::uint64_t sequence, Clock::time_point stamp) {
  frames_.push_back({sequence, stamp});
  if (frames_.size() > kKept) frames_.pop_front();
}

double FrameCadence::delay_s(Clock::time_point stamp) const {
  const auto frame = std::ranges::lower_bound(frames_, stamp, {}, &Frame::stamp);
  if (frame == frames_.end() || frame - frames_.begin() < kReach) return 0;
  const auto steps = [](auto at) { return static_cast<double>(at->sequence - std::prev(at)->sequence); };
  const auto interval_s = [](auto at) {
    return std::chrono::duration<double>(at->stamp - std::prev(at)->stamp).count();
  };
  std::vector<double> periods_s;
  for (auto at = std::next(frames_.begin()); at != frames_.end(); ++at)
    periods_s.push_back(interval_s(at) / steps(at));
  const auto middle = periods_s.begin() + static_cast<std::ptrdiff_t>(periods_s.size() / 2);
  std::ranges::nth_element(periods_s, middle);
  double delay_s = 0;
  for (auto at = frame; at != frame - kReach; --at)
    delay_s = std::max(delay_s, interval_s(at) - steps(at) * *middle);
  return delay_s;
}

}  // namespace calibrd
