// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <variant>
#include <vector>

#include "drivers/robot/motion/motion_machine.hpp"
#include "drivers/robot/simple_message/decode.hpp"
#include "drivers/robot/simple_message/encode.hpp"

namespace calibrd {

namespace sm = simple_message;
using namespace std::chrono_literals;

inline ControllerStatus fine_status(Clock::time_point stamp) {
  ControllerStatus status;
  status.drives_powered = status.motion_possible = true;
  status.e_stopped = status.in_error = status.in_motion = false;
  status.mode = ControllerStatus::Mode::automatic;
  status.stamp = stamp;
  return status;
}

/// A motion machine with its clock, a controller that answers, and a robot of two joints that follows.
class MotionMachineTest : public testing::Test {
 protected:
  using Post = std::int32_t;

  MotionMachineTest() {
    settings_.format = {sm::ByteOrder::big, 4};
    settings_.limits = {0.2, 0.5};
    settings_.hold = 500ms;
    RobotLinkHealth health;
    health.state = RobotLinkHealth::State::streaming;
    watch_.take(health);
    for (int i = 0; i < 60; ++i) pass(25ms);
  }

  /// Starts towards these postures, connects, and lets the controller answer.
  void start(std::vector<std::vector<double>> postures = {{0.4, -0.2}}) {
    machine_.emplace(MotionOrder{robot_, std::move(postures)}, settings_, watch_);
    obey(machine_->start(now_));
  }
  void start_and_connect(std::vector<std::vector<double>> postures = {{0.4, -0.2}}) {
    start(std::move(postures));
    ASSERT_TRUE(is_connecting_);
    obey(machine_->on_connected(now_));
  }

  /// Lets time pass in one piece: the robot moves, then the controller reports. Then the timer fires.
  void pass(std::chrono::milliseconds time) {
    now_ += time;
    follow();
    if (joints_come_) watch_.take(ControllerJoints{0, robot_, {}, ++joint_messages_, now_ - joints_age_});
    auto status = fine_status(now_);
    status.in_motion = is_moving_;
    if (change_status_) change_status_(status);
    if (status_comes_) watch_.take(status);
    if (machine_) obey(machine_->on_watch(now_));
    if (machine_ && timer_ && *timer_ <= now_) obey(machine_->on_tick(now_));
  }
  template <class Done>
  void pass_until(Done done, std::chrono::seconds limit = 60s) {
    for (const auto end = now_ + limit; !done();) {
      ASSERT_LT(now_, end) << "waited in vain";
      pass(10ms);
    }
  }
  /// Until the robot is well under way.
  void pass_until_halfway() {
    pass_until([&] { return points_.size() > 12; });
  }

  void obey(const MotionSteps& steps) {
    for (const auto& step : steps) {
      if (const auto* timer = std::get_if<motion_step::ArmTimer>(&step)) timer_ = timer->at;
      if (std::holds_alternative<motion_step::Connect>(step)) is_connecting_ = true;
      if (std::holds_alternative<motion_step::Close>(step)) ++closes_;
      if (const auto* reached = std::get_if<motion_step::Reached>(&step)) reached_ = reached->postures;
      if (const auto* finish = std::get_if<motion_step::Finish>(&step)) end_ = finish->end;
      if (const auto* send = std::get_if<motion_step::Send>(&step)) {
        said_.push_back(send->what);
        hear(*sm::decode(send->bytes, settings_.format));
      }
    }
  }

  /// The controller takes a request and answers as `result_of_` says.
  void hear(const sm::Message& message) {
    sm::MotionReply reply;
    if (const auto* control = std::get_if<sm::MotionControl>(&message.body)) {
      commands_.push_back(control->command);
      reply = {control->group, control->sequence, control->command, 0, 0, {}};
    } else {
      const auto& point = std::get<sm::JointTrajectoryPointFull>(message.body);
      points_.push_back(point);
      reply = {point.robot_id, point.sequence, sm::JointTrajectoryPointFull::kType, 0, 0, {}};
    }
    if (!answers_) return;
    if (on_request_) on_request_(reply);
    if (reply.command == sm::JointTrajectoryPointFull::kType && reply.result == 0) run(points_.back());
    if (reply.command == 200111) stop_following();
    const bool hangs_up = reply.command == 200130;
    if (hangs_up) return obey(machine_->on_closed({}, now_));
    obey(machine_->on_received(
        sm::encode({sm::CommType::service_reply, sm::ReplyCode::success, reply}, settings_.format), now_));
  }

  void run(const sm::JointTrajectoryPointFull& point) {
    if (point.sequence == 0) queue_.clear();
    if (point.sequence == 1) began_ = now_;
    queue_.push_back(point);
  }
  void stop_following() { queue_.clear(); }
  /// Straight between the points; enough for a robot that follows.
  void follow() {
    is_moving_ = false;
    if (queue_.size() < 2 || !follows_) return;
    const double t = std::chrono::duration<double>(now_ - began_).count();
    is_moving_ = t < queue_.back().time_s;
    for (std::size_t i = 1; i < queue_.size(); ++i) {
      const auto &a = queue_[i - 1], &b = queue_[i];
      if (t < a.time_s) continue;
      const double share = std::min(1.0, (t - a.time_s) / (b.time_s - a.time_s));
      for (std::size_t j = 0; j < 2; ++j)
        robot_[j] = a.positions[j] + share * (b.positions[j] - a.positions[j]);
    }
  }

  /// It went as a stop must: stop motion, stop trajectory mode, disconnect, close, and this is why.
  void expect_stopped(MotionError why) {
    ASSERT_TRUE(end_) << "it goes on";
    ASSERT_TRUE(end_->error) << "it succeeded";
    EXPECT_EQ(end_->error->code, why) << end_->error->message();
    ASSERT_GE(commands_.size(), 3u);
    EXPECT_EQ(std::vector<Post>(commands_.end() - 3, commands_.end()),
              (std::vector<Post>{200111, 200122, 200130}));
    EXPECT_EQ(closes_, 1);
  }
  /// Nothing was opened, nothing sent.
  void expect_refused(MotionError why) {
    ASSERT_TRUE(end_) << "it began";
    ASSERT_TRUE(end_->error);
    EXPECT_EQ(end_->error->code, why) << end_->error->message();
    EXPECT_FALSE(is_connecting_);
    EXPECT_TRUE(commands_.empty());
  }

  Clock::time_point now_{1000s};
  MotionSettings settings_;
  MotionWatch watch_{{}};
  std::optional<MotionMachine> machine_;

  std::vector<double> robot_{0.1, 0.2};
  bool follows_ = true, joints_come_ = true, status_comes_ = true, answers_ = true;
  std::chrono::milliseconds joints_age_{0};
  std::function<void(ControllerStatus&)> change_status_;
  std::function<void(sm::MotionReply&)> on_request_;
  std::uint64_t joint_messages_ = 0;

  std::vector<sm::JointTrajectoryPointFull> points_, queue_;
  Clock::time_point began_{};
  bool is_moving_ = false, is_connecting_ = false;
  int closes_ = 0;
  std::vector<Post> commands_;
  std::vector<std::string> said_;
  std::size_t reached_ = 0;
  std::optional<MotionEnd> end_;
  std::optional<Clock::time_point> timer_;
};

}  // namespace calibrd
