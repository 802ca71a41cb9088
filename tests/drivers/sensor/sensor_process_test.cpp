// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Frames through the whole path: fake driver, real OpenNI2, calibrd-sensor, ring, SensorProcess.
#include "tests/drivers/sensor/sensor_test_support.hpp"

namespace calibrd::fake {
namespace {

TEST_F(SensorTest, DeliversDepthAndInfraredOfTheSameMoment) {
  start(settings());
  for (int i = 0; i < 50; ++i) {
    const auto received = frame();
    ASSERT_TRUE(received);
    const int index = index_of(received->depth);
    ASSERT_GE(index, 1);
    if (i == 0) continue;  // the streams start one after the other
    ASSERT_TRUE(received->image);
    EXPECT_TRUE(is_infrared(*received->image, index));
  }
  EXPECT_EQ(sensor_->health().state, SensorHealth::State::streaming);
  EXPECT_NE(sensor_->health().device.find("fake://sensor/0"), std::string::npos);
}

TEST_F(SensorTest, CountsAsTheDeviceDoes) {
  start(settings());
  auto previous = frame();
  for (int i = 0; i < 100 && previous; ++i) {
    const auto now = frame();
    ASSERT_TRUE(now);
    const auto advance = static_cast<int>(now->sequence - previous->sequence);
    EXPECT_EQ(index_of(now->depth) - index_of(previous->depth), advance);
    EXPECT_GE(advance, 1);
    EXPECT_GT(now->stamp, previous->stamp);
    EXPECT_LE(now->stamp, Clock::now());
    previous = now;
  }
}

TEST_F(SensorTest, CountsFramesTheDeviceLeftOut) {
  write({.skip = 2});
  start(settings());
  const auto first = frame();
  auto last = frame();
  while (last && last->sequence < first->sequence + 30) last = frame();
  EXPECT_GE(sensor_->health().frames_lost, 20u);
}

TEST_F(SensorTest, DoesNotDeliverARepeatedFrameTwice) {
  write({.repeat = 3});
  start(settings());
  int previous = 0;
  for (int i = 0; i < 30; ++i) {
    const auto received = frame();
    ASSERT_TRUE(received);
    EXPECT_GT(index_of(received->depth), previous);
    previous = index_of(received->depth);
  }
}

TEST_F(SensorTest, DeliversFramesOfADriverThatNumbersNothing) {
  write({.numbered = 0});
  start(settings());
  const auto first = frame(), second = frame();
  ASSERT_TRUE(first && second);
  EXPECT_GT(second->sequence, first->sequence);
}

TEST_F(SensorTest, DeliversDepthWithoutImageWhereThereIsNoInfrared) {
  write({.infrared = 0});
  start(settings());
  const auto received = frame();
  ASSERT_TRUE(received);
  EXPECT_GE(index_of(received->depth), 1);
  EXPECT_FALSE(received->image);
  EXPECT_TRUE(
      reach([](const SensorHealth& h) { return h.notice.find("depth without image") != std::string::npos; }));
}

TEST_F(SensorTest, SaysThatImagesMatchNoDepthFrame) {
  write({.image_shift_us = 700'000'000});
  start(settings());
  const auto received = frame();
  ASSERT_TRUE(received);
  EXPECT_FALSE(received->image);
  EXPECT_TRUE(reach(
      [](const SensorHealth& h) { return h.notice.find("matches the depth frames") != std::string::npos; }));
}

TEST_F(SensorTest, MakesRegisteredColorGrey) {
  write({.color = 1, .registers = 1});
  auto wanted = settings();
  wanted.stream.image = ImageKind::color;
  start(wanted);
  frame();
  const auto received = frame();
  ASSERT_TRUE(received && received->image);
  EXPECT_TRUE(is_color(*received->image, index_of(received->depth)));
}

TEST_F(SensorTest, LeavesOutColorThatIsNotRegistered) {
  write({.color = 1, .registers = 0});
  auto wanted = settings();
  wanted.stream.image = ImageKind::color;
  start(wanted);
  const auto received = frame();
  ASSERT_TRUE(received);
  EXPECT_FALSE(received->image);
  EXPECT_TRUE(reach([](const SensorHealth& h) { return h.notice.find("register") != std::string::npos; }));
}

TEST_F(SensorTest, TakesPaddedRows) {
  write({.row_padding = 10});
  start(settings());
  const auto received = frame();
  ASSERT_TRUE(received);
  EXPECT_GE(index_of(received->depth), 1);
}

TEST_F(SensorTest, UndoesMirroringThatCannotBeSwitchedOff) {
  write({.mirrored = 1});
  start(settings());
  const auto received = frame();
  ASSERT_TRUE(received);
  EXPECT_GE(index_of(received->depth), 1);
}

TEST_F(SensorTest, TakesTheUnitOfDepthFromTheMode) {
  write({.unit_100_um = 1});
  start(settings());
  const auto received = frame();
  ASSERT_TRUE(received);
  EXPECT_EQ(received->depth.scale_m, 0.0001);
}

TEST_F(SensorTest, ChoosesADeviceByUriPatternOrSerial) {
  write({.devices = 2});
  for (const char* device : {"fake://sensor/1", "*sensor/1", "serial:SN1"}) {
    auto wanted = settings();
    wanted.stream.device = device;
    start(wanted);
    const auto received = frame();
    ASSERT_TRUE(received) << device;
    EXPECT_EQ(received->depth.raw.at(1), 1001) << device;
  }
}

}  // namespace
}  // namespace calibrd::fake
