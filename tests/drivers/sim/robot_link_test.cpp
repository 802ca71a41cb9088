// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// calibrd's robot link against the simulated controller, over real sockets.
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_future.hpp>
#include <mutex>
#include <thread>

#include "drivers/robot/rtde/error.hpp"
#include "drivers/robot/state_client.hpp"
#include "drivers/sim/controller/controller_server.hpp"
#include "tests/drivers/sim/sim_fixtures.hpp"

namespace calibrd::sim {
namespace {

namespace asio = boost::asio;
using Settings = ControllerSettings;
using State = RobotLinkHealth::State;

const Joints kJoints{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};

/// Controller and link on one thread of their own.
class LinkToSimulator : public testing::Test {
 protected:
  LinkToSimulator() : world_(test::world_from("")) {
    world_.state.motion.place(kJoints, 0);
    world_.state.other_robot.joints = {-0.1, -0.2, -0.3, -0.4, -0.5, -0.6, -0.7};
    link_.host = "127.0.0.1";
    link_.joint_count = 6;
    link_.link.reconnect_after = std::chrono::milliseconds(600);
    link_.link.eviction_within = std::chrono::milliseconds(0);
  }
  ~LinkToSimulator() override {
    if (client_) client_->stop();
    if (server_) run([this] { server_->stop(); });
    io_.stop();
    if (thread_.joinable()) thread_.join();
  }
  void start(const Settings& controller) {
    server_.emplace(
        io_, [this]() -> const WorldState& { return world_.state; }, controller);
    ASSERT_TRUE(server_->listen(0));
    link_.port = server_->port();
    RobotLinkEvents events;
    events.on_joints = [this](const ControllerJoints& joints) { keep(joints_, joints); };
    events.on_status = [this](const ControllerStatus& status) { keep(status_, status); };
    auto client = StateClient::create(io_.get_executor(), link_, std::move(events));
    ASSERT_TRUE(client) << client.error().message();
    client_.emplace(std::move(*client));
    client_->start();
    thread_ = std::thread([this] { io_.run(); });
  }
  void start_rtde(std::function<void(Settings&)> change = {}) {
    link_.driver = "ur_rtde";
    Settings controller;
    controller.protocol = Settings::Protocol::rtde;
    if (change) change(controller);
    start(controller);
  }
  template <class Work>
  std::invoke_result_t<Work> run(Work work) {
    return asio::post(io_, asio::use_future(work)).get();
  }
  void set(const std::function<void(Settings&)>& change) {
    run([&] {
      Settings settings = server_->settings();
      change(settings);
      EXPECT_TRUE(server_->apply(settings));
    });
  }
  template <class T>
  void keep(std::optional<T>& place, const T& value) {
    const std::lock_guard lock(mutex_);
    place = value;
  }
  template <class T>
  std::optional<T> last(const std::optional<T>& place) {
    const std::lock_guard lock(mutex_);
    return place;
  }
  void expect_joints(const Joints& wanted, double tolerance_rad) {
    const auto right = [&] {
      const auto joints = last(joints_);
      bool near = joints && joints->positions_rad.size() == 6;
      for (std::size_t i = 0; near && i < 6; ++i)
        near = std::abs(joints->positions_rad[i] - wanted[i]) < tolerance_rad;
      return near;
    };
    EXPECT_TRUE(test::eventually(right)) << client_->health().reason;
  }
  bool becomes(State state, const std::string& reason = "") {
    return test::eventually([&] {
      const auto health = client_->health();
      return health.state == state && health.reason.find(reason) != std::string::npos;
    });
  }

  World world_;
  asio::io_context io_;
  std::optional<ControllerServer> server_;
  StateClientSettings link_;
  std::optional<StateClient> client_;
  std::thread thread_;
  std::mutex mutex_;
  std::optional<ControllerJoints> joints_;  // guarded by mutex_
  std::optional<ControllerStatus> status_;  // guarded by mutex_
};

TEST_F(LinkToSimulator, ReadsBothByteOrders) {
  link_.byte_order = simple_message::ByteOrder::little;
  Settings controller;
  controller.big_endian = 0;
  start(controller);
  expect_joints(kJoints, 1e-6);
}

TEST_F(LinkToSimulator, FollowsTheSecondGroup) {
  link_.group = 1;
  Settings controller;
  controller.groups = 2;
  start(controller);
  expect_joints(world_.state.other_robot.joints, 1e-6);
  EXPECT_TRUE(becomes(State::streaming));
}

TEST_F(LinkToSimulator, NamesTheGroupsThatAreThere) {
  link_.group = 1;
  start({});
  EXPECT_TRUE(becomes(State::joints_stale, "the controller sends group 0, group 1 is configured"));
}

TEST_F(LinkToSimulator, ReadsJointPositionsSentFieldByField) {
  Settings controller;
  controller.protocol = Settings::Protocol::joint_position;
  controller.send_bytes = 4;
  start(controller);
  expect_joints(kJoints, 1e-6);
  EXPECT_TRUE(becomes(State::streaming));
  EXPECT_TRUE(last(joints_)->velocities_rad.empty());
  EXPECT_EQ(client_->health().framing_errors, 0U);
}

TEST_F(LinkToSimulator, ReadsRtde) {
  start_rtde();
  expect_joints(kJoints, 1e-12);
  EXPECT_TRUE(becomes(State::streaming));
  EXPECT_EQ(last(joints_)->velocities_rad.size(), 6U);
  EXPECT_TRUE(last(joints_)->controller_time_s);
  EXPECT_EQ(last(status_)->drives_powered, true);
  EXPECT_EQ(last(status_)->motion_possible, true);
}

TEST_F(LinkToSimulator, ReadsRtdeOfProtocolOneAmongTexts) {
  start_rtde([](Settings& s) {
    s.rtde_protocol = 1;
    s.rtde_texts = 1;
  });
  expect_joints(kJoints, 1e-12);
  EXPECT_EQ(client_->health().framing_errors, 0U);
}

TEST_F(LinkToSimulator, RtdeGetsAboutAsManyPackagesAsItAskedFor) {
  start_rtde();
  expect_joints(kJoints, 1e-12);
  const double from_s = *last(joints_)->controller_time_s;
  const std::uint64_t from = last(joints_)->sequence;
  ASSERT_TRUE(test::eventually([&] { return *last(joints_)->controller_time_s > from_s + 1; }));
  const auto count = static_cast<double>(last(joints_)->sequence - from);
  EXPECT_LT(count / (*last(joints_)->controller_time_s - from_s), 127);
}

TEST_F(LinkToSimulator, RtdeComesBackAfterADropAndAReboot) {
  start_rtde();
  ASSERT_TRUE(becomes(State::streaming));
  run([this] { server_->drop_clients(ControllerServer::Farewell::reset); });
  EXPECT_TRUE(test::eventually([&] { return client_->health().connects == 2; }));
  EXPECT_TRUE(becomes(State::streaming));
  set([](Settings& s) { s.mode = Settings::Mode::refuse; });
  EXPECT_TRUE(becomes(State::connecting));
  set([](Settings& s) { s.mode = Settings::Mode::normal; });
  EXPECT_TRUE(becomes(State::streaming)) << "its clock began anew";
}

TEST_F(LinkToSimulator, RtdeNamesAVariableThatIsNotThere) {
  start_rtde([](Settings& s) { s.rtde_missing = "actual_q"; });
  EXPECT_TRUE(becomes(State::faulted, "actual_q, controller software 5.2.0"));
  set([](Settings& s) { s.rtde_missing.clear(); });
  EXPECT_TRUE(becomes(State::streaming));
}

TEST_F(LinkToSimulator, RtdeNoticesAFrozenAndAPowerlessController) {
  start_rtde();
  expect_joints(kJoints, 1e-12);
  set([](Settings& s) { s.mode = Settings::Mode::frozen; });
  EXPECT_TRUE(becomes(State::joints_stale, "repeats itself"));
  set([](Settings& s) { s.mode = Settings::Mode::normal; });
  EXPECT_TRUE(becomes(State::streaming));
  set([](Settings& s) { s.mode = Settings::Mode::status_only; });
  EXPECT_TRUE(becomes(State::joints_stale, "without power"));
  EXPECT_TRUE(test::eventually([&] { return last(status_)->drives_powered == false; }));
  set([](Settings& s) { s.mode = Settings::Mode::silent; });
  EXPECT_TRUE(test::eventually([&] { return client_->health().connects == 2; })) << "silence";
}

}  // namespace
}  // namespace calibrd::sim
