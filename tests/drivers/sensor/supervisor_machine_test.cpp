// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/supervisor_machine.hpp"

#include <gtest/gtest.h>

#include <csignal>

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using Order = SupervisorMachine::Order;
using Time = SupervisorMachine::Time;

constexpr SensorTimeouts kTimeouts{.open = 10s,
                                   .heartbeat = 2s,
                                   .silence = 3s,
                                   .end = 400ms,
                                   .restart_min = 500ms,
                                   .restart_max = 5s,
                                   .stable = 10s};

/// A machine and a clock that stands still unless told.
struct Supervised {
  SupervisorMachine machine{kTimeouts};
  Time now = Time(100s);
  Pulse pulse;

  Order next() { return machine.next(now); }
  void start() {
    ASSERT_EQ(next(), Order::spawn);
    machine.on_spawned(now);
    machine.on_message(SensorHello{}, now);
  }
  void stream() {
    start();
    machine.on_message(SensorStreaming{.device = "Fake", .notice = "", .width = 1, .height = 1}, now);
    live(0ms);
  }
  void live(std::chrono::milliseconds time, bool with_frame = true) {
    now += time;
    ++pulse.heartbeat;
    if (with_frame) ++pulse.frames;
    machine.on_pulse(pulse, now);
  }
  void crash() { machine.on_end({.by_signal = true, .value = SIGSEGV}, now); }
  std::error_code why() const { return machine.failure() ? machine.failure()->code : std::error_code(); }
  std::chrono::milliseconds time_to_start() const {
    return std::chrono::duration_cast<std::chrono::milliseconds>(*machine.due() - now);
  }
};

TEST(SupervisorMachine, StartsAtOnce) {
  Supervised s;
  EXPECT_EQ(s.next(), Order::spawn);
  EXPECT_FALSE(s.machine.failure());
  EXPECT_FALSE(s.machine.is_streaming());
}

TEST(SupervisorMachine, StreamsFromTheFirstFrameOn) {
  Supervised s;
  s.start();
  s.machine.on_message(SensorStreaming{}, s.now);
  EXPECT_FALSE(s.machine.is_streaming());
  s.live(10ms);
  EXPECT_TRUE(s.machine.is_streaming());
  EXPECT_EQ(s.next(), Order::wait);
}

TEST(SupervisorMachine, BelievesFramesThatOvertakeTheMessage) {
  Supervised s;
  s.start();
  s.live(10ms);
  EXPECT_TRUE(s.machine.is_streaming());
}

TEST(SupervisorMachine, KillsADriverThatDoesNotOpen) {
  Supervised s;
  s.start();
  s.now += 10s - 1ms;
  EXPECT_EQ(s.next(), Order::wait);
  s.now += 1ms;
  EXPECT_EQ(s.next(), Order::kill);
  EXPECT_EQ(s.why(), SensorError::hung);
}

TEST(SupervisorMachine, KillsADriverWhoseHeartStopped) {
  Supervised s;
  s.stream();
  s.now += 2s;
  EXPECT_EQ(*s.machine.due(), s.now);
  EXPECT_EQ(s.next(), Order::kill);
  EXPECT_EQ(s.why(), SensorError::hung);
  s.machine.on_end({.by_signal = true, .value = SIGKILL}, s.now);
  EXPECT_EQ(s.why(), SensorError::hung) << "the kill is not the cause";
}

TEST(SupervisorMachine, AsksASilentDeviceToEndBeforeItKillsIt) {
  Supervised s;
  s.stream();
  for (int i = 0; i < 3; ++i) s.live(1s, false);
  EXPECT_EQ(s.next(), Order::terminate);
  EXPECT_EQ(s.why(), SensorError::silent);
  EXPECT_EQ(s.next(), Order::wait);
  s.now += 400ms;
  EXPECT_EQ(s.next(), Order::kill);
}

TEST(SupervisorMachine, KeepsTheReasonTheChildGave) {
  Supervised s;
  s.start();
  s.machine.on_message(SensorFailure{SensorError::no_device, "found: none"}, s.now);
  s.machine.on_end({.by_signal = false, .value = 3}, s.now);
  EXPECT_EQ(s.why(), SensorError::no_device);
  EXPECT_EQ(s.machine.failure()->detail, "found: none");
}

TEST(SupervisorMachine, KillsAChildThatFailsButLingers) {
  Supervised s;
  s.start();
  s.machine.on_message(SensorFailure{SensorError::disconnected, ""}, s.now);
  EXPECT_EQ(s.next(), Order::wait);
  s.now += 400ms;
  EXPECT_EQ(s.next(), Order::kill);
  EXPECT_EQ(s.next(), Order::wait) << "once is enough for a while";
  EXPECT_EQ(s.why(), SensorError::disconnected);
}

TEST(SupervisorMachine, NamesTheSignalOfACrash) {
  Supervised s;
  s.stream();
  s.crash();
  EXPECT_EQ(s.why(), SensorError::crashed);
  EXPECT_NE(s.machine.failure()->detail.find("signal 11"), std::string::npos);
  EXPECT_FALSE(s.machine.is_streaming());
}

TEST(SupervisorMachine, BacksOffUpToALimit) {
  Supervised s;
  for (const auto expected : {500ms, 1000ms, 2000ms, 4000ms, 5000ms, 5000ms}) {
    s.start();
    s.crash();
    EXPECT_EQ(s.time_to_start(), expected);
    s.now += expected - 1ms;
    EXPECT_EQ(s.next(), Order::wait);
    s.now += 1ms;
  }
  EXPECT_EQ(s.machine.restarts(), 5u);
}

TEST(SupervisorMachine, DoesNotForgetItsBackOffForAFewFrames) {
  Supervised s;
  s.stream();
  s.crash();
  s.now += 500ms;
  s.stream();
  s.live(5s);
  s.crash();
  EXPECT_EQ(s.time_to_start(), 1000ms);
}

TEST(SupervisorMachine, ForgetsItsBackOffAfterGoodFrames) {
  Supervised s;
  s.stream();
  s.crash();
  s.now += 500ms;
  s.stream();
  for (int i = 0; i < 10; ++i) s.live(1s);
  s.crash();
  EXPECT_EQ(s.time_to_start(), 500ms);
}

TEST(SupervisorMachine, KeepsTheReasonUntilFramesFlowAgain) {
  Supervised s;
  s.stream();
  s.crash();
  s.now += 500ms;
  s.start();
  EXPECT_EQ(s.why(), SensorError::crashed);
  s.pulse = {};
  s.machine.on_message(SensorStreaming{}, s.now);
  EXPECT_EQ(s.why(), SensorError::crashed);
  s.live(10ms);
  EXPECT_FALSE(s.machine.failure());
}

TEST(SupervisorMachine, TriesAgainWhenTheProgramCannotBeStarted) {
  Supervised s;
  ASSERT_EQ(s.next(), Order::spawn);
  s.machine.on_spawn_failed(sensor_error(SensorError::program_missing, "/x"), s.now);
  EXPECT_EQ(s.next(), Order::wait);
  EXPECT_EQ(s.why(), SensorError::program_missing);
  s.now += 500ms;
  EXPECT_EQ(s.next(), Order::spawn);
}

TEST(SupervisorMachine, RefusesAChildOfAnotherVersion) {
  Supervised s;
  ASSERT_EQ(s.next(), Order::spawn);
  s.machine.on_spawned(s.now);
  s.machine.on_message(SensorHello{kSensorLinkVersion + 1}, s.now);
  EXPECT_EQ(s.why(), SensorError::version_mismatch);
  s.now += 400ms;
  EXPECT_EQ(s.next(), Order::kill);
}

TEST(SupervisorMachine, DoesNotPlayAnEndedRecordingAgain) {
  Supervised s;
  s.stream();
  s.machine.on_message(SensorFailure{SensorError::recording_ended, "cell.oni"}, s.now);
  s.machine.on_end({.by_signal = false, .value = 3}, s.now);
  EXPECT_TRUE(s.machine.is_finished());
  EXPECT_FALSE(s.machine.due());
  s.now += 1h;
  EXPECT_EQ(s.next(), Order::wait);
  EXPECT_EQ(s.why(), SensorError::recording_ended);
}

TEST(SupervisorMachine, StopsARunningChildAndStartsNoOther) {
  Supervised s;
  s.stream();
  s.machine.stop();
  EXPECT_EQ(s.next(), Order::terminate);
  s.machine.on_end({.by_signal = false, .value = 0}, s.now);
  EXPECT_TRUE(s.machine.is_finished());
}

TEST(SupervisorMachine, StopsBetweenTwoChildren) {
  Supervised s;
  s.start();
  s.crash();
  s.machine.stop();
  EXPECT_EQ(s.next(), Order::wait);
  EXPECT_TRUE(s.machine.is_finished());
}

}  // namespace
}  // namespace calibrd
