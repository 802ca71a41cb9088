// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/link_machine.hpp"

#include <algorithm>
#include <utility>

#include "drivers/robot/robot_link_error.hpp"

namespace calibrd {

LinkSteps LinkMachine::start(Clock::time_point now) {
  if (phase_ != Phase::idle) return {};
  health_.reason = Error{RobotLinkError::connecting, {}}.message();
  connect(now);
  return finish(now);
}

LinkSteps LinkMachine::on_connected(Clock::time_point now) {
  if (phase_ != Phase::connecting) return {};
  phase_ = Phase::connected;
  connected_at_ = alive_at_ = awake_at_ = now;
  joints_stamp_.reset();
  status_stamp_.reset();
  held_joints_.reset();
  joints_problem_.reset();
  ++health_.connects;
  if (auto hello = codec_->begin(); !hello.empty()) steps_.push_back(link_step::Send{std::move(hello)});
  return finish(now);
}

LinkSteps LinkMachine::on_connect_failed(const std::error_code& why, Clock::time_point now) {
  if (phase_ != Phase::connecting) return {};
  const std::error_code code = explain_connect_failure(why);
  // What has no explanation of its own keeps the words of the operating system.
  lose(State::connecting, {code, code == RobotLinkError::connect_failed ? why.message() : std::string()},
       now);
  return finish(now);
}

LinkSteps LinkMachine::on_received(const Received& received, Clock::time_point now) {
  if (phase_ != Phase::connected) return {};
  if (now - awake_at_ >= settings_.reconnect_after) {
    // Nobody read for so long that the controller's own buffers may hold old joints as well.
    lose(State::connecting, {RobotLinkError::held_up, {}}, now);
    return finish(now);
  }
  CodecOutput output = codec_->decode(received.bytes, received.stamp);
  account(output);
  take(output, now);
  if (!received.more_waiting) deliver_joints();
  if (output.broken) {
    ++health_.framing_errors;
    lose(State::faulted, *output.broken, now);
  }
  return finish(now);
}

LinkSteps LinkMachine::on_closed(const std::error_code& why, Clock::time_point now) {
  if (phase_ != Phase::connected) return {};
  const int quick_closes = now - connected_at_ < settings_.eviction_within ? quick_closes_ + 1 : 0;
  if (quick_closes < 2) {
    lose(State::connecting,
         {why ? RobotLinkError::connection_failed : RobotLinkError::closed_by_controller, {}}, now);
  } else {
    lose(State::faulted, {RobotLinkError::evicted, {}}, now);
    wake_at_ = now + settings_.eviction_pause;
  }
  quick_closes_ = quick_closes;
  return finish(now);
}

LinkSteps LinkMachine::on_tick(Clock::time_point now) {
  const bool late = armed_ && now - *armed_ >= settings_.reconnect_after;
  armed_.reset();
  if (phase_ == Phase::waiting && now >= wake_at_) {
    connect(now);
  } else if (phase_ == Phase::connecting && now >= wake_at_) {
    lose(State::connecting, {RobotLinkError::no_answer, {}}, now);
    wake_at_ = now + settings_.backoff_first;  // the attempt itself was pause enough
  } else if (phase_ == Phase::connected && late) {
    lose(State::connecting, {RobotLinkError::held_up, {}}, now);
  } else if (phase_ == Phase::connected && now - alive_at_ >= settings_.reconnect_after) {
    lose(State::silent, {RobotLinkError::silent, {}}, now);
  }
  return finish(now);
}

LinkSteps LinkMachine::on_trouble(const std::string& what, Clock::time_point now) {
  steps_.clear();
  armed_.reset();  // the shell may never have heard of it
  if (phase_ == Phase::stopped) return {};
  lose(State::connecting, {RobotLinkError::out_of_resources, what}, now);
  return finish(now);
}

LinkSteps LinkMachine::stop() {
  if (phase_ == Phase::stopped) return {};
  phase_ = Phase::stopped;
  health_.state = State::connecting;
  health_.reason = Error{RobotLinkError::stopped, {}}.message();
  health_.status_fresh = false;
  return {link_step::Close{}};
}

void LinkMachine::connect(Clock::time_point now) {
  phase_ = Phase::connecting;
  wake_at_ = now + settings_.connect_timeout;
  steps_.push_back(link_step::Connect{});
}

void LinkMachine::lose(State state, const Error& why, Clock::time_point now) {
  // Only a connection that lasted makes the next pause short again: a controller that accepts and then sends
  // rubbish must not be hammered.
  const bool settled = phase_ == Phase::connected && now - connected_at_ >= settings_.reconnect_after;
  if (settled) backoff_ = settings_.backoff_first;
  quick_closes_ = 0;
  steps_.push_back(link_step::Close{});
  phase_ = Phase::waiting;
  wake_at_ = now + backoff_;
  backoff_ = std::min(2 * backoff_, settings_.backoff_cap);
  health_.state = state;
  health_.reason = why.message();
  health_.status_fresh = false;
}

void LinkMachine::account(const CodecOutput& output) {
  health_.messages += output.messages;
  health_.rejected_values += output.rejected_values;
  health_.other_group += output.other_group;
  health_.skipped_messages += output.skipped;
}

void LinkMachine::take(CodecOutput& output, Clock::time_point now) {
  if (output.messages > 0) alive_at_ = now;
  if (output.joints_problem) joints_problem_ = std::move(output.joints_problem);
  if (output.joints) {
    sequence_ += output.joint_messages;
    held_joints_ = std::move(output.joints);
    held_joints_->sequence = sequence_;
  }
  if (output.status) {
    status_stamp_ = output.status->stamp;
    steps_.push_back(link_step::DeliverStatus{*output.status});
  }
  if (!output.reply.empty()) steps_.push_back(link_step::Send{std::move(output.reply)});
}

void LinkMachine::deliver_joints() {
  if (!held_joints_) return;
  joints_stamp_ = held_joints_->stamp;
  joints_problem_.reset();
  steps_.push_back(link_step::DeliverJoints{std::move(*held_joints_)});
  held_joints_.reset();
}

bool LinkMachine::fresh(const std::optional<Clock::time_point>& stamp, Clock::time_point now) const {
  return stamp && now - *stamp < settings_.stale_after;
}

void LinkMachine::judge_connection(Clock::time_point now) {
  health_.status_fresh = fresh(status_stamp_, now);
  if (fresh(joints_stamp_, now)) {
    health_.state = State::streaming;
    health_.reason.clear();
  } else if (!joints_stamp_ && fresh(connected_at_, now)) {
    return;  // just connected: what was known before still holds
  } else if (fresh(alive_at_, now)) {
    health_.state = State::joints_stale;
    health_.reason = joints_problem_.value_or(Error{RobotLinkError::joints_missing, {}}).message();
  } else {
    health_.state = State::silent;
    health_.reason = Error{RobotLinkError::silent, {}}.message();
  }
}

Clock::time_point LinkMachine::next_deadline(Clock::time_point now) const {
  if (phase_ != Phase::connected) return wake_at_;
  Clock::time_point next = alive_at_ + settings_.reconnect_after;
  for (const auto& stamp :
       {joints_stamp_, status_stamp_, std::optional(connected_at_), std::optional(alive_at_)}) {
    if (fresh(stamp, now)) next = std::min(next, *stamp + settings_.stale_after);
  }
  return next;
}

LinkSteps LinkMachine::finish(Clock::time_point now) {
  if (phase_ == Phase::idle || phase_ == Phase::stopped) return {};
  awake_at_ = now;
  if (phase_ == Phase::connected) judge_connection(now);
  const bool changed = health_.state != reported_.state || health_.reason != reported_.reason ||
                       health_.status_fresh != reported_.status_fresh;
  if (changed) {
    reported_ = health_;
    steps_.push_back(link_step::ReportHealth{health_});
  }
  // A timer that fires too early only asks again; so it is not re-armed with every message.
  if (const auto next = next_deadline(now); !armed_ || next < *armed_) {
    armed_ = next;
    steps_.push_back(link_step::ArmTimer{next});
  }
  return std::exchange(steps_, {});
}

}  // namespace calibrd
