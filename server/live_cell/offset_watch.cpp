// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/offset_watch.hpp"

#include <cmath>

namespace calibrd {
namespace {

using namespace std::chrono_literals;

constexpr auto kSpeedReach = 40ms;   ///< joints over this much to both sides tell whether the robot moves
constexpr auto kLargestGap = 110ms;  ///< between joints of use: speed is not known across longer ones

Clock::duration duration_of(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

OffsetWatch::OffsetWatch(std::unique_ptr<TimeOffsetEstimator> estimator,
                         std::shared_ptr<const LinkReach> reach, const OffsetWatchSettings& settings)
    : estimator_(std::move(estimator)), reach_(std::move(reach)), settings_(settings) {}

void OffsetWatch::offer(const std::shared_ptr<const Sighting>& sighting) {
  if (!estimator_ || waiting_ || sighting->stamp - looked_at_ < settings_.period) return;
  looked_at_ = sighting->stamp;
  waiting_ = sighting;
}

/// Begins anew after another link, keeps the offset alone after another pose. False: nothing to compare with.
bool OffsetWatch::follow(const std::optional<OffsetBasis>& basis, std::uint64_t link) {
  if (link != link_) estimator_->reset();
  if (basis && basis->pose_number != pose_number_) estimator_->forget_pose();
  link_ = link;
  if (basis) pose_number_ = basis->pose_number;
  const std::lock_guard lock(mutex_);
  has_basis_ = basis.has_value();
  return has_basis_;
}

bool OffsetWatch::is_moving(const JointHistory& joints, Clock::time_point stamp) const {
  const auto before = joints.positions_at(stamp - kSpeedReach),
             after = joints.positions_at(stamp + kSpeedReach);
  if (!before || !after) return false;
  const std::chrono::duration<double> span = 2 * kSpeedReach;
  return reach_->farthest_m(*before, *after) > settings_.least_speed_m_s * span.count();
}

void OffsetWatch::work(const LiveRobot& robot, const std::optional<OffsetBasis>& basis, std::uint64_t link) {
  if (!estimator_) return;
  if (!follow(basis, link)) waiting_.reset();
  if (waiting_) {
    const auto stamp = waiting_->stamp - settings_.latency;
    const auto begin = stamp - estimator_->joints_before(), end = stamp + estimator_->joints_after();
    const auto newest = robot.newest_joints();
    if (newest && newest->stamp < end && Clock::now() - waiting_->stamp < 1s) return;  // still to come
    const auto sighting = std::move(waiting_);
    const JointHistory joints = robot.read_joints([](const JointHistory& history) { return history; });
    if (joints.motion(begin, end, kLargestGap) && !joints.freeze().is_frozen() && is_moving(joints, stamp))
      estimator_->add({sighting->view.depth, stamp, basis->T_base_sensor, basis->correction},
                      [&](Clock::time_point time) { return joints.positions_at(time); });
  }
  publish(Clock::now());
}

void OffsetWatch::publish(Clock::time_point now) {
  const auto estimate = estimator_->estimate();
  const std::lock_guard lock(mutex_);
  const bool is_new = estimate && (!estimate_ || estimate->value_s != estimate_->value_s);
  if (is_new) updated_at_ = now;
  estimate_ = estimate;
  is_applied_ =
      estimate && estimate->sigma_s < (is_applied_ ? settings_.drop_sigma_s : settings_.apply_sigma_s);
}

std::optional<AppliedOffset> OffsetWatch::applied() const {
  const std::lock_guard lock(mutex_);
  if (!is_applied_) return std::nullopt;
  return AppliedOffset{duration_of(estimate_->value_s), std::hypot(estimate_->sigma_s, estimate_->jitter_s)};
}

api::TimeOffsetReport OffsetWatch::report(Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  api::TimeOffsetReport report;
  report.is_estimated = estimator_ != nullptr;
  report.applied = is_applied_;
  if (estimate_) {
    report.value = api::Seconds(estimate_->value_s);
    report.sigma = api::Seconds(estimate_->sigma_s);
    report.jitter = api::Seconds(estimate_->jitter_s);
    report.age = now - *updated_at_;
  }
  if (!estimator_)
    report.reason = "sensors.ID.time_offset is off: the configured latencies are taken for true";
  else if (!has_basis_ && !is_applied_)
    report.reason =
        "it is estimated against a calibrated pose; calibrate with the robot standing still first";
  else if (!is_applied_)
    report.reason = "it is not known well enough yet; let the robot move in view of the sensor, to and fro";
  return report;
}

}  // namespace calibrd
