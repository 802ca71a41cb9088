// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/motion/motion_client.hpp"

#include <gtest/gtest.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_future.hpp>
#include <condition_variable>
#include <thread>

#include "drivers/robot/state_client.hpp"
#include "drivers/sim/controller/motion_server.hpp"

/// The client against the simulated controller, over real sockets: state port and motion port.
namespace calibrd {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;

/// An io_context with a thread.
struct Loop {
  asio::io_context io{1};
  asio::executor_work_guard<asio::io_context::executor_type> work = asio::make_work_guard(io);
  std::thread thread{[this] { io.run(); }};
  ~Loop() {
    io.stop();
    thread.join();
  }
  /// Runs it on the thread, and waits.
  template <class Work>
  auto run(Work work) {
    return asio::post(io, asio::use_future(std::move(work))).get();
  }
};

class MotionClientTest : public testing::Test {
 protected:
  MotionClientTest() {
    world_.joint_count = 7;
    world_.motion.place(sim::Joints{0.1, 0.2, 0.3}, sim::monotonic_ns());
    simulator_.run([this] {
      EXPECT_TRUE(state_.listen(0));
      EXPECT_TRUE(motion_.listen(0));
    });
    MotionClientSettings settings;
    settings.host = "127.0.0.1";
    settings.port = motion_.port();
    settings.motion.limits = {0.3, 1};
    settings.motion.hold = 200ms;
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
    for (const auto end = Clock::now() + 20s; !done();) {
      ASSERT_LT(Clock::now(), end) << "waited in vain";
      changed_.wait_for(lock, 5ms);
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
    std::this_thread::sleep_for(100ms);
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

TEST_F(MotionClientTest, VisitsPosturesAndClosesThePort) {
  start({posture(0.4, 0.0, 0.3), posture(0.2, 0.1, 0.2)});
  wait_for_end(std::nullopt);
  EXPECT_EQ(reached_, 2u);
  const auto joints = robot();
  for (const auto& [joint, expected] : {std::pair{0, 0.2}, {1, 0.1}, {2, 0.2}})
    EXPECT_NEAR(joints[static_cast<std::size_t>(joint)], expected, 1e-6);
  wait_for([&] { return !simulator_.run([this] { return motion_.has_client(); }); });
  EXPECT_EQ(simulator_.run([this] { return motion_.accepted(); }), 1u);
  EXPECT_EQ(counts().count(200111), 0u);
}

TEST_F(MotionClientTest, OpensNothingUntilItIsAskedTo) {
  wait_for([&] { return !client_->doubt(); });
  EXPECT_EQ(simulator_.run([this] { return motion_.accepted(); }), 0u);
}

TEST_F(MotionClientTest, AStopStopsTheRobotAndEndsTrajectoryMode) {
  start({posture(1.4, 0.0, 0.3)});
  wait_until_under_way();
  client_->stop(MotionError::stop_requested);
  wait_for_end(MotionError::stop_requested);
  expect_the_robot_stands();
  EXPECT_LT(robot()[0], 1.0);
  const auto sent = counts();
  for (const std::int32_t command : {200111, 200122, 200130}) EXPECT_EQ(sent.at(command), 1) << command;
  wait_for([&] { return client_->doubt().has_value(); });
  EXPECT_EQ(client_->doubt()->code, MotionError::motion_not_possible);
}

TEST_F(MotionClientTest, AnEmergencyStopEndsIt) {
  start({posture(1.4, 0.0, 0.3)});
  wait_until_under_way();
  set([](auto& settings) { settings.e_stopped = 1; });
  wait_for([&] { return end_.has_value(); });
  ASSERT_TRUE(end_ && end_->error);  // the next status says so, or the answer to the next point
  EXPECT_NE(end_->error->message().find("emergency stop"), std::string::npos) << end_->error->message();
  expect_the_robot_stands();
}

TEST_F(MotionClientTest, AStateLinkThatDiesEndsIt) {
  start({posture(1.4, 0.0, 0.3)});
  wait_until_under_way();
  set([](auto& settings) { settings.mode = sim::ControllerSettings::Mode::refuse; });
  wait_for_end(MotionError::link_down);
  expect_the_robot_stands();
}

TEST_F(MotionClientTest, JointsThatFreezeEndIt) {
  start({posture(1.4, 0.0, 0.3)});
  wait_until_under_way();
  set([](auto& settings) { settings.mode = sim::ControllerSettings::Mode::frozen; });
  wait_for_end(MotionError::off_path);
  expect_the_robot_stands();
}

TEST_F(MotionClientTest, AnotherClientOfThePortEndsItAndIsTold) {
  start({posture(0.1, 0.2, 0.3)});  // stands still at it: nothing is queued in the end
  wait_for([&] { return reached_ == 1; });
  asio::io_context io;
  asio::ip::tcp::socket other(io);
  other.connect({asio::ip::address_v4::loopback(), motion_.port()});
  wait_for_end(MotionError::closed_by_controller);
}

TEST_F(MotionClientTest, AnotherMotionIsRefusedMeanwhile) {
  start({posture(1.4, 0.0, 0.3)});
  const auto second = client_->start({posture(0.1, 0.2, 0.3), {posture(0, 0, 0)}}, {});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, MotionError::in_motion);
}

TEST_F(MotionClientTest, ClosingStopsTheRobotToo) {
  start({posture(1.4, 0.0, 0.3)});
  wait_until_under_way();
  client_->shut_down();
  wait_for_end(MotionError::daemon_ends);
  wait_for([&] { return !simulator_.run([this] { return motion_.has_client(); }); });
  expect_the_robot_stands();
}

TEST_F(MotionClientTest, AManualRobotIsNotMoved) {
  set([](auto& settings) { settings.automatic = 0; });
  wait_for([&] { return client_->doubt()->code == MotionError::not_automatic; });
  const auto begun = client_->start({posture(0.1, 0.2, 0.3), {posture(0, 0, 0)}}, {});
  ASSERT_FALSE(begun);
  EXPECT_EQ(simulator_.run([this] { return motion_.accepted(); }), 0u);
}

TEST(MotionClientSettings, PortsForOtherThingsAreRefused) {
  MotionClientSettings settings;
  EXPECT_TRUE(check(settings));
  for (const int port : {0, 70000, 50241, 50242, 11002, 11003}) {
    settings.port = port;
    ASSERT_FALSE(check(settings)) << port;
    EXPECT_EQ(check(settings).error().code, MotionError::port_not_for_motion);
  }
  settings.port = settings.state_port = 9000;
  EXPECT_FALSE(check(settings));
}

}  // namespace
}  // namespace calibrd
