// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/motion/motion_machine.hpp"

#include <utility>

#include "drivers/robot/motion/motion_error.hpp"
#include "drivers/robot/robot_link_error.hpp"

namespace calibrd {

MotionMachine::MotionMachine(MotionOrder order, MotionSettings settings, const MotionWatch& watch)
    : order_(std::move(order)),
      settings_(settings),
      watch_(watch),
      codec_(settings_.format, settings_.group) {}

MotionSteps MotionMachine::start(Clock::time_point now) {
  if (phase_ != Phase::idle) return {};
  error_ = watch_.doubt_before_start(now);
  if (!error_ && is_elsewhere()) error_ = Error{MotionError::moved_since_checked, {}};
  if (error_) {
    end();
  } else {
    phase_ = Phase::connecting;
    answer_due_ = now + settings_.connect_timeout;
    steps_.push_back(motion_step::Connect{});
  }
  return finish(now);
}

MotionSteps MotionMachine::on_connected(Clock::time_point now) {
  if (phase_ != Phase::connecting) return {};
  phase_ = Phase::checking;
  answer_due_.reset();
  look(now);  // what has come to light while the connection was made
  if (phase_ == Phase::checking)
    send(MotionCommand::check_motion_ready, "before anything moves", settings_.reply_timeout, now);
  return finish(now);
}

MotionSteps MotionMachine::on_connect_failed(const std::error_code& why, Clock::time_point now) {
  if (phase_ != Phase::connecting) return {};
  error_ = Error{MotionError::connect_failed, explain_connect_failure(why).message()};
  end();
  return finish(now);
}

MotionSteps MotionMachine::on_received(std::span<const std::byte> bytes, Clock::time_point now) {
  if (!is_commanding() && !is_stopping()) return {};
  const auto answers = codec_.decode(bytes);
  if (!answers) {
    give_up({MotionError::reply_unreadable, answers.error().message()}, now);
    if (is_stopping()) end();  // nothing that follows can be read: closing stops the robot as well
    return finish(now);
  }
  for (const MotionAnswer& answer : *answers) take(answer, now);
  look(now);
  return finish(now);
}

MotionSteps MotionMachine::on_closed(const std::error_code& why, Clock::time_point now) {
  if (phase_ == Phase::idle || phase_ == Phase::ended) return {};
  if (!error_) error_ = Error{MotionError::closed_by_controller, why ? why.message() : std::string()};
  end();
  return finish(now);
}

MotionSteps MotionMachine::on_watch(Clock::time_point now) {
  if (phase_ == Phase::idle || phase_ == Phase::ended) return {};
  look(now);
  return finish(now);
}

MotionSteps MotionMachine::on_tick(Clock::time_point now) { return on_watch(now); }

MotionSteps MotionMachine::stop(MotionError why, Clock::time_point now) {
  if (phase_ == Phase::idle || phase_ == Phase::ended) return {};
  give_up({why, {}}, now);
  return finish(now);
}

/// Not where the way was checked from, before the first move.
bool MotionMachine::is_elsewhere() const {
  return widest_gap(watch_.joints()->positions_rad, order_.from_rad).rad > settings_.path.joint_rad;
}

/// Looks at everything that can end the motion or is due.
void MotionMachine::look(Clock::time_point now) {
  if (phase_ == Phase::ended) return;
  if (is_stopping()) {
    if (answer_due_ && now >= *answer_due_) end();
    return;
  }
  if (auto doubt = find_doubt(now)) return give_up(*std::move(doubt), now);
  if (phase_ == Phase::moving) go_on_moving(now);
  if (phase_ == Phase::holding) go_on_holding(now);
}

std::optional<Error> MotionMachine::find_doubt(Clock::time_point now) const {
  if (now - looked_at_ > settings_.held_up_after) return Error{MotionError::held_up, {}};
  if (auto doubt = watch_.doubt(now)) return doubt;
  const ControllerJoints& joints = *watch_.joints();
  if (path_) {
    if (auto doubt = path_->deviation(joints.positions_rad, joints.stamp, settings_.path)) return doubt;
  } else if (!watch_.stands()) {
    return Error{MotionError::in_motion, {}};
  } else if (is_elsewhere()) {
    return Error{MotionError::moved_since_checked, {}};
  }
  if (answer_due_ && now >= *answer_due_)
    return Error{phase_ == Phase::connecting ? MotionError::connect_failed : MotionError::no_reply, {}};
  return std::nullopt;
}

void MotionMachine::give_up(Error why, Clock::time_point now) {
  if (is_stopping() || phase_ == Phase::ended) return;
  const bool can_be_told = is_commanding();
  error_ = std::move(why);
  if (!can_be_told) return end();
  phase_ = Phase::stopping;
  send(MotionCommand::stop_motion, error_->message(), settings_.stop_timeout, now);
}

/// Each command of the stop is sent once; where one is not obeyed, the connection is closed at once: MotoROS
/// moves nothing without one.
void MotionMachine::go_on_stopping(const MotionAnswer& answer, Clock::time_point now) {
  if (phase_ == Phase::stopping) {
    if (answer.result != MotionResult::success) return end();
    phase_ = Phase::leaving;
    send(MotionCommand::stop_trajectory_mode, "the motion was stopped", settings_.stop_timeout, now);
  } else if (phase_ == Phase::leaving) {
    phase_ = Phase::disconnecting;
    send(MotionCommand::disconnect, "the motion was stopped", settings_.stop_timeout, now);
  } else {
    end();
  }
}

void MotionMachine::end() {
  if (phase_ != Phase::idle) steps_.push_back(motion_step::Close{});
  phase_ = Phase::ended;
  steps_.push_back(motion_step::Finish{{error_}});
}

MotionSteps MotionMachine::finish(Clock::time_point now) {
  looked_at_ = now;
  if (phase_ != Phase::ended) steps_.push_back(motion_step::ArmTimer{now + settings_.watch_period});
  return std::exchange(steps_, {});
}

}  // namespace calibrd
