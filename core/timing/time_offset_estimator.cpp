// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/timing/time_offset_estimator.hpp"

#include <algorithm>

namespace calibrd {
namespace {

/// Joints are asked for a little beside a moment, too: for their speed.
constexpr double kMargin_s = 0.03;
/// Around what the search has found, the filter may go on by itself.
constexpr double kPull_s = 0.04;

Clock::duration in_seconds(double s) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

}  // namespace

TimeOffsetEstimator::TimeOffsetEstimator(const VirtualCell& cell, const CameraModel& camera,
                                         const TimeOffsetSettings& settings)
    : settings_(settings),
      motion_(cell, camera, settings.frame),
      search_(settings.search),
      filter_(settings.filter) {}

void TimeOffsetEstimator::reset() {
  search_.reset();
  filter_.reset();
  rough_s_.reset();
}

Clock::duration TimeOffsetEstimator::joints_before() const {
  return in_seconds((rough_s_ ? std::max(*rough_s_, 0.0) + kPull_s : settings_.search.most_s) + kMargin_s);
}

Clock::duration TimeOffsetEstimator::joints_after() const {
  return in_seconds((rough_s_ ? std::max(-*rough_s_, 0.0) + kPull_s : -settings_.search.least_s) + kMargin_s);
}

bool TimeOffsetEstimator::search(const TimedFrame& frame, const JointsAt& joints_at) {
  std::vector<double> misfits;
  for (const double dt_s : search_.candidates_s()) {
    const auto misfit = motion_.misfit(frame, joints_at, dt_s);
    if (!misfit) return false;
    misfits.push_back(*misfit);
  }
  search_.add(misfits);
  rough_s_ = search_.found_s();
  return true;
}

bool TimeOffsetEstimator::add(const TimedFrame& frame, const JointsAt& joints_at) {
  if (!rough_s_) return search(frame, joints_at);
  const double around_s =
      std::clamp(filter_.working_value().value_or(*rough_s_), *rough_s_ - kPull_s, *rough_s_ + kPull_s);
  const auto equations = motion_.observe(frame, joints_at, around_s);
  if (!equations) return false;
  filter_.add(*equations, std::chrono::duration<double>(frame.stamp.time_since_epoch()).count());
  if (filter_.is_lost()) reset();
  return true;
}

std::optional<TimeOffset> TimeOffsetEstimator::estimate() const {
  const auto found = filter_.estimate();
  if (!found) return std::nullopt;
  return TimeOffset{found->offset_s, found->sigma_s, found->jitter_s, found->blocks};
}

}  // namespace calibrd
