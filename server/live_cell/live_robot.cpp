// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/live_robot.hpp"

namespace calibrd {
namespace {

const char* name_of(RobotLinkHealth::State state) {
  switch (state) {
    case RobotLinkHealth::State::connecting:
      return "connecting";
    case RobotLinkHealth::State::streaming:
      return "streaming";
    case RobotLinkHealth::State::joints_stale:
      return "joints_stale";
    case RobotLinkHealth::State::silent:
      return "silent";
    case RobotLinkHealth::State::faulted:
      return "faulted";
  }
  return "faulted";
}

const char* name_of(ControllerStatus::Mode mode) {
  switch (mode) {
    case ControllerStatus::Mode::manual:
      return "manual";
    case ControllerStatus::Mode::automatic:
      return "automatic";
    case ControllerStatus::Mode::unknown:
      break;
  }
  return "unknown";
}

api::ControllerReport controller_report(const ControllerStatus& status, bool fresh, Clock::time_point now) {
  return {status.drives_powered,  status.e_stopped,     status.in_error,   status.in_motion,
          status.motion_possible, name_of(status.mode), status.error_code, fresh,
          now - status.stamp};
}

}  // namespace

LiveRobot::LiveRobot(const RobotModel& model, JointMapping mapping, ViewGateSettings stillness,
                     Clock::duration latency, std::optional<ControllerFrame> controller_frame)
    : model_(model),
      mapping_(std::move(mapping)),
      stillness_(stillness),
      latency_(latency),
      controller_frame_(std::move(controller_frame)),
      history_(2 * stillness.settle_time + std::chrono::seconds(2)) {
  health_.reason = "connecting for the first time";
}

RobotLinkEvents LiveRobot::events() {
  RobotLinkEvents events;
  events.on_joints = [this](const ControllerJoints& joints) { take(joints); };
  events.on_status = [this](const ControllerStatus& status) {
    const std::lock_guard lock(mutex_);
    status_ = status;
    history_.note_status(status.stamp - latency_,
                         stillness_.trust_in_motion ? status.in_motion : std::nullopt);
  };
  events.on_health = [this](const RobotLinkHealth& health) {
    const std::lock_guard lock(mutex_);
    health_ = health;
  };
  return events;
}

void LiveRobot::set_health_source(std::function<RobotLinkHealth()> source) {
  const std::lock_guard lock(mutex_);
  health_source_ = std::move(source);
}

void LiveRobot::take(const ControllerJoints& joints) {
  auto positions = mapping_.positions(joints.positions_rad);
  auto velocities = joints.velocities_rad.empty() ? Result<std::vector<double>>(std::vector<double>())
                                                  : mapping_.velocities(joints.velocities_rad);
  const std::lock_guard lock(mutex_);
  mapping_problem_ = positions ? std::string() : positions.error().message();
  if (!positions) return;
  controller_values_ = joints.positions_rad;
  history_.add({*std::move(positions), velocities ? *std::move(velocities) : std::vector<double>(),
                joints.sequence, joints.stamp - latency_});
}

bool LiveRobot::is_stale(const JointState& joints) const {
  const std::lock_guard lock(mutex_);
  return Clock::now() - joints.stamp > stillness_.stale_after || history_.freeze().is_frozen();
}

std::uint64_t LiveRobot::connects() const {
  const std::lock_guard lock(mutex_);
  return health_source_ ? health_source_().connects : health_.connects;
}

std::optional<JointState> LiveRobot::newest_joints() const {
  const std::lock_guard lock(mutex_);
  const auto* newest = history_.newest();
  return newest ? std::optional<JointState>(*newest) : std::nullopt;
}

Result<std::vector<double>> LiveRobot::controller_values(std::span<const double> positions_rad) const {
  const std::lock_guard lock(mutex_);
  return mapping_.controller_values(positions_rad, controller_values_);
}

api::RobotReport LiveRobot::report() const {
  const auto now = Clock::now();
  bool streaming = false;
  api::RobotReport report;
  report.model = model_.name();
  report.base_frame = model_.base_link();
  if (controller_frame_) report.controller_frame = controller_frame_->link;
  report.joint_names = model_.position_names();
  {
    const std::lock_guard lock(mutex_);
    const auto health = health_source_ ? health_source_() : health_;
    streaming = health.state == RobotLinkHealth::State::streaming;
    report.link_state = name_of(health.state);
    report.link_reason = mapping_problem_.empty() ? health.reason : mapping_problem_;
    report.connects = health.connects;
    report.framing_errors = health.framing_errors;
    report.rejected_values = health.rejected_values;
    if (const auto* newest = history_.newest()) report.joints = *newest;
    report.joints_frozen = history_.freeze().is_frozen();
    report.still = is_still(history_, stillness_, now);
    if (status_) report.controller = controller_report(*status_, health.status_fresh, now);
  }
  if (!report.joints) return report;
  report.joints_age = now - report.joints->stamp;
  report.joints_stale = report.joints_age > stillness_.stale_after || !streaming;
  const auto poses = model_.forward_kinematics(report.joints->positions_rad);
  for (std::size_t i = 0; i < poses.size(); ++i) report.links.push_back({model_.links()[i].name, poses[i]});
  return report;
}

}  // namespace calibrd
