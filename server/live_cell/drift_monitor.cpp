// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/drift_monitor.hpp"

#include <algorithm>

#include "server/live_cell/posture_collector.hpp"

namespace calibrd {
namespace {

constexpr std::size_t kSeries = 600, kEvents = 100;
constexpr double kSamplePeriod_s = 1;
/// Frames that passed a check, to learn a background from, a second apart: of two postures, for one shows
/// nothing behind the robot; of one where the robot keeps standing.
constexpr std::size_t kFramesToLearn = 3, kMostFramesToLearn = 10;
/// A sensor that has moved by 3 mm or 3 mrad shows within so many (docs/figures.md) of its background.
constexpr int kFramesToShow = 15;
/// While the background is hidden, as behind something that was parked there, the robot alone can tell: it is
/// heard after so many times as many.
constexpr int kHiddenFramesForOne = 4;
/// Without a frame for so long nothing is known of now.
constexpr api::Seconds kSilent{2};
constexpr double kBetweenFrames_s = 1, kOtherPosture_rad = 0.1;

Clock::time_point time_of(double stamp_s) {
  return Clock::time_point(
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(stamp_s)));
}

}  // namespace

void DriftMonitor::set_pose(const Pose& T_base_sensor, std::shared_ptr<const BackgroundMap> background) {
  const std::lock_guard lock(mutex_);
  order_ = Order{T_base_sensor, background};
  has_pose_ = true;
  newest_ = fresh_;
  background_ = background && !background->is_empty() ? std::move(background) : nullptr;
  in_place_ = wants_check_ = out_of_sight_ = contested_ = unsettled_ = false;
  quarters_seen_ = 0;
}

void DriftMonitor::on_sensor_lost() {
  passed_.clear();
  watch_->on_gap();
  const std::lock_guard lock(mutex_);
  in_place_ = false;
  quarters_seen_ = 0;
}

bool DriftMonitor::has_looked() const {
  const std::lock_guard lock(mutex_);
  return !background_ || quarters_seen_ >= kHiddenFramesForOne * kFramesToShow;
}

void DriftMonitor::take_order() {
  std::optional<Order> order;
  {
    const std::lock_guard lock(mutex_);
    order.swap(order_);
  }
  if (!order) return;
  passed_.clear();
  watch_->set_pose(order->T_base_sensor);
  if (order->background) watch_->set_background(*order->background);
}

void DriftMonitor::add_frame(const View& frame) {
  take_order();
  {
    const std::lock_guard lock(mutex_);
    if (!has_pose_) return;
  }
  const DriftReport& report = watch_->add_frame(frame);
  const std::lock_guard lock(mutex_);
  if (order_) return;  // a pose that came meanwhile: this was of the last one
  note(report, frame.stamp_s);
  count_frame();
  in_place_ = watch_->is_in_place();
  wants_check_ = watch_->wants_check();
  out_of_sight_ = watch_->is_out_of_sight();
  contested_ = watch_->is_contested();
  unsettled_ = watch_->is_unsettled();
  stamp_ = time_of(frame.stamp_s);
}

/// A sensor that goes dark, or sees again, was away meanwhile; one that is touched is dark for a moment only.
/// Where it stays dark, the robot alone can tell, as where the background is hidden.
void DriftMonitor::count_frame() {
  const bool was_dark = frames_dark_ >= kFramesToShow;
  frames_dark_ = watch_->is_dark() ? frames_dark_ + 1 : 0;
  if (was_dark ? frames_dark_ == 0 : frames_dark_ == kFramesToShow)
    quarters_seen_ = 0;
  else if (was_dark || frames_dark_ == 0)
    quarters_seen_ += watch_->innovation() ? kHiddenFramesForOne : 1;
}

void DriftMonitor::note(const DriftReport& report, double now_s) {
  if (report.verdict != newest_.verdict || events_.empty()) {
    events_.push_back({time_of(now_s), name_of(report.verdict)});
    if (events_.size() > kEvents) events_.pop_front();
  }
  const auto at = time_of(now_s);
  if (series_.empty() || at - series_.back().stamp >= std::chrono::duration<double>(kSamplePeriod_s)) {
    series_.push_back({at, 0, 0, 0, 0});
    if (series_.size() > kSeries) series_.pop_front();
  }
  api::DriftSample& sample = series_.back();
  sample.statistic = std::max(sample.statistic, report.statistic);
  sample.shift_m = report.shift_m;
  sample.turn_rad = report.turn_rad;
  sample.depth_offset_change_m = report.depth_offset_change_m;
  newest_ = report;
}

void DriftMonitor::add_check(const View& frame, const PoseCheck& check) {
  watch_->add_check(check, frame.joint_positions_rad, frame.stamp_s);
  if (check.enough_evidence && !check.agrees) passed_.clear();
  if (check.agrees && !watch_->has_background()) keep_for_background(frame);
  const std::lock_guard lock(mutex_);
  if (order_) return;
  contested_ = watch_->is_contested();
  unsettled_ = watch_->is_unsettled();
}

void DriftMonitor::keep_for_background(const View& frame) {
  if (!passed_.empty() && frame.stamp_s - passed_.back().stamp_s < kBetweenFrames_s) return;
  passed_.push_back(frame);
  const bool several = std::ranges::any_of(passed_, [&](const View& other) {
    return posture_distance(other.joint_positions_rad, frame.joint_positions_rad) > kOtherPosture_rad;
  });
  if (passed_.size() < (several ? kFramesToLearn : kMostFramesToLearn)) return;
  watch_->learn(passed_);
  passed_.clear();
  if (!watch_->has_background()) return;
  auto learnt = std::make_shared<const BackgroundMap>(watch_->background());
  const std::lock_guard lock(mutex_);
  if (!order_) background_ = std::move(learnt);
}

std::shared_ptr<const BackgroundMap> DriftMonitor::background() const {
  const std::lock_guard lock(mutex_);
  return background_;
}

DriftVerdict DriftMonitor::verdict() const {
  const std::lock_guard lock(mutex_);
  return newest_.verdict;
}

bool DriftMonitor::is_in_place() const {
  const std::lock_guard lock(mutex_);
  return in_place_;
}

bool DriftMonitor::is_out_of_sight() const {
  const std::lock_guard lock(mutex_);
  return out_of_sight_;
}

bool DriftMonitor::is_contested() const {
  const std::lock_guard lock(mutex_);
  return contested_;
}

bool DriftMonitor::is_unsettled() const {
  const std::lock_guard lock(mutex_);
  return unsettled_;
}

bool DriftMonitor::wants_check() const {
  const std::lock_guard lock(mutex_);
  return wants_check_;
}

double DriftMonitor::depth_offset_change_m() const {
  const std::lock_guard lock(mutex_);
  return newest_.depth_offset_change_m;
}

std::optional<RestingPlace::Sight> DriftMonitor::sensor_seen() const {
  const std::lock_guard lock(mutex_);
  if (!newest_.T_base_sensor_seen) return std::nullopt;
  return RestingPlace::Sight{*newest_.T_base_sensor_seen, newest_.seen_shift_sigma_m,
                             newest_.seen_turn_sigma_rad};
}

api::DriftReport DriftMonitor::report() const {
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  api::DriftReport report;
  report.watched = has_pose_;
  report.now = newest_;
  if (has_pose_ && stamp_ != Clock::time_point()) report.age = now - stamp_;
  if (report.age && *report.age > kSilent) report.now.verdict = DriftVerdict::no_evidence;
  report.series.assign(series_.begin(), series_.end());
  report.events.assign(events_.begin(), events_.end());
  return report;
}

}  // namespace calibrd
