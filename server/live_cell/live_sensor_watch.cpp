// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// How LiveSensor follows the pose that it serves, frame by frame.
#include <utility>

#include "server/live_cell/live_sensor.hpp"

namespace calibrd {
void LiveSensor::watch(const Sighting& sighting) {
  if (!monitor_) return;
  monitor_->add_frame(sighting.view);
  notice_move();
  const std::lock_guard lock(mutex_);  // a pose that is set now resets what the monitor says
  if (sighting.stamp <= lost_at_) return;
  const bool was_plausible = watch_.is_plausible();
  const bool has_moved = monitor_->verdict() == DriftVerdict::sensor_moved;
  if (has_moved && !has_moved_) moved_at_ = Clock::now();
  has_moved_ = has_moved;
  if (has_moved) watch_.on_sensor_moved();
  watch_.on_contested(is_contested());
  // While a single thing shows a slide, a frame whose noise hides that slide proves nothing: so this comes
  // first.
  if (monitor_->is_out_of_sight())
    watch_.on_view_lost();
  else if (monitor_->is_in_place())
    watch_.on_background_in_place(sighting.stamp);
  forget_evidence(was_plausible);
}

/// A pose that is not good yet does not become so before a slide that one thing in view shows is settled.
bool LiveSensor::is_contested() const {
  return monitor_->is_contested() ||
         (monitor_->is_unsettled() && watch_.state() != api::PoseState::calibrated);
}

/// It was found where the sensor stood before.
void LiveSensor::forget_evidence(bool was_plausible) {
  if (was_plausible && !watch_.is_plausible()) evidence_.reset();
}

void LiveSensor::notice_move() {
  std::uint64_t pose_number = 0;
  {
    const std::lock_guard lock(mutex_);
    pose_number = pose_number_;
  }
  if (std::exchange(resting_number_, pose_number) != pose_number) resting_place_.forget();
  if (!resting_place_.is_new(monitor_->sensor_seen())) return;
  {
    const std::lock_guard lock(mutex_);
    moved_at_ = Clock::now();
  }
  for (const auto& task : open_tasks()) task->start_over();
}

bool LiveSensor::is_check_due(Clock::time_point now) const {
  constexpr auto kAtMost = std::chrono::milliseconds(100);
  return watch_.is_check_due(now) || (monitor_ && monitor_->wants_check() && now - checked_at_ >= kAtMost);
}

void LiveSensor::check(const Sighting& sighting) {
  std::unique_lock lock(mutex_);
  if (!known_ || sighting.stamp <= lost_at_ || !is_check_due(Clock::now())) return;
  if (monitor_ && !monitor_->has_looked()) return;
  checked_at_ = Clock::now();
  const auto number = pose_number_;
  const auto pose = *known_->result.T_base_sensor;
  const auto covariance = known_->result.covariance;
  auto correction = known_->result.depth_correction;
  if (monitor_) correction.offset_m += monitor_->depth_offset_change_m();
  lock.unlock();
  const auto checked = check_(sighting.view, pose, correction, covariance);
  lock.lock();
  if (number != pose_number_) return;
  if (monitor_) monitor_->add_check(sighting.view, checked);
  const bool was_plausible = watch_.is_plausible();
  if (monitor_) watch_.on_contested(is_contested());
  const bool was_good = watch_.state() == api::PoseState::calibrated;
  watch_.on_check(checked, sighting.stamp);  // not now: a check proves nothing of later than its frame
  // What was found of frames before is no better than the pose that these speak against.
  if (was_good && checked.enough_evidence && !checked.agrees) moved_at_ = Clock::now();
  forget_evidence(was_plausible);
}

}  // namespace calibrd
