// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/freeze_watch.hpp"

#include <algorithm>

namespace calibrd {
namespace {

/// A controller says "in motion" when a motion is queued; the encoders follow within a few tenths of a
/// second.
constexpr auto kPatience = std::chrono::milliseconds(400);

}  // namespace

void FreezeWatch::on_joints(Clock::time_point stamp, bool changed) {
  if (!changed) return;
  is_frozen_ = false;
  unchanged_ = Clock::duration::zero();
  if (in_motion_at_) in_motion_at_ = stamp;
}

void FreezeWatch::on_status(Clock::time_point stamp, std::optional<bool> in_motion) {
  newest_status_ = stamp;
  if (!in_motion.value_or(false)) {
    in_motion_at_.reset();
    return;
  }
  in_motion_.push_back(stamp);
  while (stamp - in_motion_.front() > span_) in_motion_.pop_front();
  if (in_motion_at_) unchanged_ += std::max(Clock::duration::zero(), stamp - *in_motion_at_);
  in_motion_at_ = stamp;
  if (unchanged_ >= kPatience) is_frozen_ = true;
}

bool FreezeWatch::said_in_motion(Clock::time_point begin, Clock::time_point end) const {
  return std::ranges::any_of(in_motion_,
                             [&](Clock::time_point said) { return said >= begin && said <= end; });
}

}  // namespace calibrd
