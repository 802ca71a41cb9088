// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The simulated sensor's faults through the real OpenNI2 library.
#include <future>

#include "tests/drivers/sim/openni_fixture.hpp"

namespace calibrd::sim {
namespace {

using openni::OpenNI;
using test::OpenNi;

TEST_F(OpenNi, SilentSensorDeliversNothingUntilItSpeaksAgain) {
  open();
  start();
  ASSERT_TRUE(next(depth_).isValid());
  world_.set_mode(SensorMode::silent);
  EXPECT_TRUE(test::eventually([&] { return !next(depth_, 300).isValid(); }));
  world_.set_mode(SensorMode::normal);
  EXPECT_TRUE(next(depth_).isValid());
}

TEST_F(OpenNi, HangingSensorBlocksItsCaller) {
  open();
  start();
  ASSERT_TRUE(next(depth_).isValid());
  world_.set_mode(SensorMode::hanging);
  auto stopping = std::async(std::launch::async, [&] { depth_.stop(); });
  EXPECT_EQ(stopping.wait_for(std::chrono::milliseconds(300)), std::future_status::timeout);
  world_.set_mode(SensorMode::normal);
  EXPECT_EQ(stopping.wait_for(std::chrono::seconds(10)), std::future_status::ready);
}

struct Plugs : OpenNI::DeviceConnectedListener, OpenNI::DeviceDisconnectedListener {
  Plugs() {
    OpenNI::addDeviceConnectedListener(this);
    OpenNI::addDeviceDisconnectedListener(this);
  }
  ~Plugs() override {
    OpenNI::removeDeviceConnectedListener(this);
    OpenNI::removeDeviceDisconnectedListener(this);
  }
  void onDeviceConnected(const openni::DeviceInfo*) override { ++in; }
  void onDeviceDisconnected(const openni::DeviceInfo*) override { ++out; }
  std::atomic<int> in = 0, out = 0;
};

TEST_F(OpenNi, UnplugAndReplugAreAnnounced) {
  Plugs plugs;
  open();
  start();
  ASSERT_TRUE(next(depth_).isValid());
  world_.set_mode(SensorMode::unplugged);
  EXPECT_TRUE(test::eventually([&] { return plugs.out == 1; }));
  EXPECT_TRUE(test::eventually([&] { return !next(depth_, 300).isValid(); }));
  depth_.destroy();
  infrared_.destroy();
  device_.close();
  EXPECT_NE(device_.open("calibrd-sim://0"), openni::STATUS_OK);
  world_.set_mode(SensorMode::normal);
  EXPECT_TRUE(test::eventually([&] { return plugs.in == 1; }));
  open();
  start();
  EXPECT_TRUE(next(depth_).isValid());
}

TEST_F(OpenNi, SimulatorThatRestartsIsFoundAgain) {
  Plugs plugs;
  open();
  start();
  ASSERT_TRUE(next(depth_).isValid());
  world_.stop();
  EXPECT_TRUE(test::eventually([&] { return plugs.out == 2; }));
  depth_.destroy();
  infrared_.destroy();
  device_.close();
  world_.start();
  EXPECT_TRUE(test::eventually([&] { return plugs.in == 2; }));
  open();
  start();
  EXPECT_TRUE(next(depth_).isValid());
}

TEST_F(OpenNi, CrashEndsTheProcessThatHoldsTheSensor) {
  test::ChildProgram client({CALIBRD_PLAIN_CLIENT, "calibrd-sim://0"});
  // Each further crash is another order; a client that has not opened the device yet overlooks the ones
  // before.
  const auto crash = [&] {
    world_.change([](WorldState& state) { ++state.sensors[0].crashes; });
    return client.wait(std::chrono::milliseconds(200)) == 1000 + SIGABRT;
  };
  EXPECT_TRUE(test::eventually(crash));
}

}  // namespace
}  // namespace calibrd::sim
