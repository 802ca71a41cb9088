// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/robot/link_machine.hpp"
#include "drivers/robot/robot_link_error.hpp"
#include "drivers/robot/simple_message/encode.hpp"
#include "drivers/robot/simple_message_codec.hpp"

namespace calibrd {

/// Frames as a big-endian controller sends them.
namespace wire {
using Bytes = std::vector<std::byte>;
using simple_message::ByteOrder;
using simple_message::JointFeedback;
using simple_message::kValidPositions;
using simple_message::RobotStatus;

constexpr simple_message::WireFormat kBig{simple_message::ByteOrder::big, 4};

inline Bytes topic(simple_message::Body body, simple_message::WireFormat format = kBig) {
  return simple_message::encode(
      {simple_message::CommType::topic, simple_message::ReplyCode::none, std::move(body)}, format);
}
inline Bytes joints(double first) { return topic(JointFeedback{0, kValidPositions, 0, {first}, {}, {}}); }
inline Bytes status() { return topic(RobotStatus{1, 0, 0, 0, 0, 2, 1}); }
inline Bytes state_cycle() {
  Bytes bytes = joints(0.1);
  const Bytes more = status();
  bytes.insert(bytes.end(), more.begin(), more.end());
  return bytes;
}

}  // namespace wire

/// A machine, its clock, and what it asked for.
class LinkMachineTest : public testing::Test {
 protected:
  using State = RobotLinkHealth::State;
  void obey(const LinkSteps& steps) {
    last_ = steps;
    for (const LinkStep& step : steps) {
      if (const auto* timer = std::get_if<link_step::ArmTimer>(&step)) timer_ = timer->at;
      if (const auto* delivery = std::get_if<link_step::DeliverJoints>(&step))
        joints_.push_back(delivery->joints);
      if (const auto* delivery = std::get_if<link_step::DeliverStatus>(&step))
        statuses_.push_back(delivery->status);
      if (const auto* report = std::get_if<link_step::ReportHealth>(&step))
        reports_.push_back(report->health);
    }
  }
  template <class Step>
  bool asked_to() const {
    return std::ranges::any_of(last_,
                               [](const LinkStep& step) { return std::holds_alternative<Step>(step); });
  }
  void receive(const wire::Bytes& bytes, bool more_waiting = false) {
    obey(machine_.on_received({bytes, now_, more_waiting}, now_));
  }
  /// Lets time pass; the timer fires whenever the machine asked for it. Stops early when it asks for a
  /// connection.
  void pass(std::chrono::milliseconds time) {
    const auto end = now_ + time;
    last_.clear();
    while (timer_ && *timer_ <= end) {
      now_ = std::max(now_, *timer_);
      timer_.reset();
      obey(machine_.on_tick(now_));
      if (asked_to<link_step::Connect>()) return;
    }
    now_ = end;
  }
  void start_and_connect() {
    obey(machine_.start(now_));
    obey(machine_.on_connected(now_));
  }
  void stream_for(std::chrono::milliseconds time) {
    for (const auto end = now_ + time; now_ < end; pass(std::chrono::milliseconds(25)))
      receive(wire::state_cycle());
  }
  /// How long the machine pauses before it asks for the next connection.
  std::chrono::milliseconds pause() {
    const auto begin = now_;
    pass(std::chrono::seconds(60));
    EXPECT_TRUE(asked_to<link_step::Connect>());
    return std::chrono::duration_cast<std::chrono::milliseconds>(now_ - begin);
  }
  State state() const { return machine_.health().state; }
  bool reason_is(const std::error_code& error) const {
    return machine_.health().reason.ends_with(error.message());
  }

  Clock::time_point now_{std::chrono::seconds(1000)};
  LinkMachine machine_{std::make_unique<SimpleMessageCodec>(SimpleMessageSettings{}), LinkSettings{}};
  LinkSteps last_;
  std::optional<Clock::time_point> timer_;
  std::vector<ControllerJoints> joints_;
  std::vector<ControllerStatus> statuses_;
  std::vector<RobotLinkHealth> reports_;
};

}  // namespace calibrd
