// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_future.hpp>
#include <condition_variable>
#include <map>
#include <thread>

#include "drivers/robot/motion/motion_client.hpp"
#include "drivers/robot/state_client.hpp"
#include "drivers/sim/controller/motion_server.hpp"

namespace calibrd {

/// An io_context with a thread.
struct Loop {
  boost::asio::io_context io{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work =
      boost::asio::make_work_guard(io);
  std::thread thread{[this] { io.run(); }};
  ~Loop() {
    io.stop();
    thread.join();
  }
  /// Runs it on the thread, and waits.
  template <class Work>
  auto run(Work work) {
    return boost::asio::post(io, boost::asio::use_future(std::move(work))).get();
  }
};

/// The client against the simulated controller, over real sockets: state port and motion port.
class MotionClientTest : public testing::Test {
 protected:
  explicit MotionClientTest(const MotionSettings& motion = slow(), const MotionWatchSettings& watch = {}) {
    world_.joint_count = 7;
    world_.motion.place(sim::Joints{0.1, 0.2, 0.3}, sim::monotonic_ns());
    simulator_.run([this] {
      EXPECT_TRUE(state_.listen(0));
      EXPECT_TRUE(motion_.listen(0));
    });
    MotionClientSettings settings;
    settings.host = "127.0.0.1";
    settings.port = motion_.port();
    settings.motion = motion;
    settings.watch = watch;
    client_ = std::make_shared<MotionClient>(loop_.io.get_executor(), settings);
    StateClientSettings link;
    link.host = "127.0.0.1";
    link.port = state_.port();
    link.joint_count = 7;
    RobotLinkEvents events;
    events.on_joints = [this](const auto& joints) { client_->take(joints); };
    events.on_status = [this](const auto& status) { client_->take(status); };
    events.on_health = [this](const auto& health) { client_->take(health); };
    auto created = StateClient::create(loop_.io.get_executor(), link, std::move(events));
    EXPECT_TRUE(created);
    link_.emplace(*std::move(created));
    link_->start();
  }
  ~MotionClientTest() override {
    link_->stop();
    client_->shut_down();
    simulator_.run([this] {
      motion_.stop();
      state_.stop();
    });
  }

  static MotionSettings slow() {
    MotionSettings settings;
    settings.limits = {0.3, 1};
    settings.hold = std::chrono::milliseconds(200);
    return settings;
  }
  static std::vector<double> posture(double a, double b, double c) { return {a, b, c, 0, 0, 0, 0}; }

  /// Starts as soon as the robot has been seen at rest.
  void start(std::vector<std::vector<double>> postures) {
    wait_for([&] { return !client_->doubt(); });
    MotionEvents events;
    events.on_command = [this](const std::string& what) { note([&] { commands_.push_back(what); }); };
    events.on_reached = [this](std::size_t reached) { note([&] { reached_ = reached; }); };
    events.on_end = [this](const MotionEnd& end) { note([&] { end_ = end; }); };
    const auto begun = client_->start({posture(0.1, 0.2, 0.3), std::move(postures)}, std::move(events));
    ASSERT_TRUE(begun) << begun.error().message();
  }
  template <class Change>
  void note(Change change) {
    const std::lock_guard lock(mutex_);
    change();
    changed_.notify_all();
  }
  template <class Done>
  void wait_for(Done done) {
    std::unique_lock lock(mutex_);
    for (const auto end = Clock::now() + std::chrono::seconds(20); !done();) {
      ASSERT_LT(Clock::now(), end) << "waited in vain";
      changed_.wait_for(lock, std::chrono::milliseconds(5));
    }
  }
  void wait_for_end(std::optional<MotionError> why) {
    wait_for([&] { return end_.has_value(); });
    if (why) {
      ASSERT_TRUE(end_ && end_->error);
      EXPECT_EQ(end_->error->code, *why) << end_->error->message();
    } else {
      ASSERT_TRUE(end_);
      EXPECT_FALSE(end_->error) << end_->error->message();
    }
  }
  void wait_until_under_way() {
    wait_for([&] { return commands_.size() > 12; });
  }
  sim::Joints robot() {
    return simulator_.run([this] { return world_.motion.positions_at(sim::monotonic_ns()); });
  }
  void set(void (*change)(sim::ControllerSettings&)) {
    simulator_.run([&] {
      auto settings = state_.settings();
      change(settings);
      EXPECT_TRUE(state_.apply(settings));
      motion_.look_at_settings();
    });
  }
  std::map<std::int32_t, std::int32_t> counts() {
    return simulator_.run([this] { return motion_.commands().counts(); });
  }
  void expect_the_robot_stands() {
    const auto here = robot();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_EQ(robot(), here);
  }

  sim::WorldState world_;  // belongs to the simulator's thread
  Loop simulator_;
  sim::ControllerServer state_{simulator_.io, [this]() -> const sim::WorldState& { return world_; }, {}};
  sim::MotionServer motion_{simulator_.io,
                            {[this]() -> const sim::WorldState& { return world_; },
                             [this](const sim::WorldState& world) { world_ = world; }},
                            state_};
  Loop loop_;
  std::shared_ptr<MotionClient> client_;
  std::optional<StateClient> link_;

  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::vector<std::string> commands_;
  std::size_t reached_ = 0;
  std::optional<MotionEnd> end_;
};

}  // namespace calibrd
