// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The simulated sensor through the real OpenNI2 library.
#include <cmath>
#include <filesystem>

#include "tests/drivers/sim/openni_fixture.hpp"

namespace calibrd::sim {
namespace {

using openni::Device;
using openni::OpenNI;
using openni::VideoFrameRef;
using openni::VideoStream;
using test::OpenNi;

TEST_F(OpenNi, ListsEverySensorOfTheWorldAndNoOther) {
  openni::Array<openni::DeviceInfo> devices;
  OpenNI::enumerateDevices(&devices);
  ASSERT_EQ(devices.getSize(), 2);
  EXPECT_STREQ(devices[0].getUri(), "calibrd-sim://0");
  EXPECT_STREQ(devices[1].getUri(), "calibrd-sim://1");
  EXPECT_STREQ(devices[0].getVendor(), "calibrd");
}

TEST_F(OpenNi, OffersDepthAndInfraredAsAKinectDoes) {
  open();
  const openni::VideoMode depth = depth_.getVideoMode(), infrared = infrared_.getVideoMode();
  EXPECT_EQ(depth.getPixelFormat(), openni::PIXEL_FORMAT_DEPTH_1_MM);
  EXPECT_EQ(infrared.getPixelFormat(), openni::PIXEL_FORMAT_GRAY16);
  for (const auto& mode : {depth, infrared}) {
    EXPECT_EQ(mode.getResolutionX(), 512);
    EXPECT_EQ(mode.getResolutionY(), 424);
    EXPECT_EQ(mode.getFps(), 30);
  }
  EXPECT_NEAR(depth_.getHorizontalFieldOfView(), 2 * std::atan(256 / 365.6), 1e-5);
  EXPECT_NEAR(depth_.getVerticalFieldOfView(), 2 * std::atan(212 / 365.6), 1e-5);
  EXPECT_EQ(depth_.getMinPixelValue(), 0);
  EXPECT_FALSE(depth_.getMirroringEnabled());
  openni::VideoMode other = depth;
  other.setResolution(640, 480);
  EXPECT_NE(depth_.setVideoMode(other), openni::STATUS_OK);
  EXPECT_EQ(depth_.setVideoMode(depth), openni::STATUS_OK);
  EXPECT_FALSE(device_.hasSensor(openni::SENSOR_COLOR));
}

TEST_F(OpenNi, FramesShowTheWorldAtTheirTimestamp) {
  world_.change([](WorldState& state) {
    // One long turn: at a turning point there would be nothing to tell two moments apart.
    state.motion.visit(std::vector{Joints{30, 0.5}}, Profile::constant_speed, 0.5, 0,
                       monotonic_ns() - 1'000'000'000);
  });
  open();
  start();
  for (int i = 0; i < 3; ++i) {
    const VideoFrameRef frame = next(depth_);
    ASSERT_TRUE(frame.isValid());
    const auto time_ns = static_cast<std::int64_t>(frame.getTimestamp()) * 1000;
    EXPECT_LT(std::abs(monotonic_ns() - time_ns), 2'000'000'000);
    const auto seen = pixels(frame);
    const auto differing = [&](std::int64_t at_ns) {
      const auto right = expected(at_ns).depth_mm;
      int count = 0;
      for (std::size_t p = 0; p < seen.size(); ++p) count += std::abs(seen[p] - right[p]) > 1;
      return count;
    };
    EXPECT_LE(differing(time_ns), 10);               // the timestamp is cut off to a microsecond
    EXPECT_GT(differing(time_ns + 15'000'000), 30);  // not half a period later
  }
}

TEST_F(OpenNi, DepthAndInfraredAreOfTheSameMoment) {
  open();
  start();
  VideoFrameRef depth = next(depth_), infrared = next(infrared_);
  ASSERT_TRUE(depth.isValid() && infrared.isValid());
  ASSERT_TRUE(test::eventually([&] {  // one of them may have started a frame earlier
    if (depth.getFrameIndex() < infrared.getFrameIndex()) depth = next(depth_);
    if (infrared.getFrameIndex() < depth.getFrameIndex()) infrared = next(infrared_);
    return depth.getFrameIndex() == infrared.getFrameIndex();
  }));
  EXPECT_EQ(depth.getTimestamp(), infrared.getTimestamp());
  const auto right = expected(static_cast<std::int64_t>(depth.getTimestamp()) * 1000);
  EXPECT_EQ(pixels(depth), right.depth_mm);
  EXPECT_EQ(pixels(infrared), right.infrared);
}

TEST_F(OpenNi, FrameIndicesCountThirtiethsOfASecond) {
  open();
  start();
  const VideoFrameRef first = next(depth_);
  for (int i = 0; i < 10; ++i) {
    const VideoFrameRef frame = next(depth_);
    ASSERT_TRUE(frame.isValid());
    const double periods = static_cast<double>(frame.getTimestamp() - first.getTimestamp()) * 30e-6;
    EXPECT_NEAR(frame.getFrameIndex() - first.getFrameIndex(), periods, 1e-3);
  }
}

TEST_F(OpenNi, MirroringTurnsTheRowsRound) {
  open();
  start();
  const auto plain = pixels(next(depth_));
  depth_.setMirroringEnabled(true);
  ASSERT_TRUE(test::eventually([&] {
    auto mirrored = pixels(next(depth_));
    for (std::size_t row = 0; row < mirrored.size(); row += 512)
      std::reverse(mirrored.begin() + static_cast<std::ptrdiff_t>(row),
                   mirrored.begin() + static_cast<std::ptrdiff_t>(row) + 512);
    return mirrored == plain;
  }));
}

TEST_F(OpenNi, ErrorsSetAtRunTimeShowInTheNextFrames) {
  open();
  start();
  const auto before = pixels(next(depth_));
  world_.change([](WorldState& state) { state.sensors[0].depth.offset_m = 0.1; });
  EXPECT_TRUE(test::eventually([&] {
    const auto after = pixels(next(depth_));
    return after[212 * 512 + 256] == before[212 * 512 + 256] + 100;
  }));
}

TEST_F(OpenNi, OpeningAndClosingLeavesNothingBehind) {
  const auto threads = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/task"),
                         std::filesystem::directory_iterator());
  };
  std::ptrdiff_t after_first = 0;
  for (int i = 0; i < 6; ++i) {
    open();
    start();
    ASSERT_TRUE(next(depth_).isValid());
    depth_.destroy();
    infrared_.destroy();
    device_.close();
    if (i == 0) after_first = threads();
  }
  EXPECT_EQ(threads(), after_first);
}

TEST_F(OpenNi, RecordingPlaysBackTheSameDepth) {
  const calibrd::test::ScratchFolder folder;
  const std::string file = (folder.path() / "take.oni").string();
  open();
  ASSERT_EQ(depth_.start(), openni::STATUS_OK);
  openni::Recorder recorder;
  ASSERT_EQ(recorder.create(file.c_str()), openni::STATUS_OK);
  ASSERT_EQ(recorder.attach(depth_), openni::STATUS_OK);
  ASSERT_EQ(recorder.start(), openni::STATUS_OK);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(next(depth_).isValid());
  const auto live = pixels(next(depth_));
  recorder.stop();
  recorder.destroy();
  Device player;
  ASSERT_EQ(player.open(file.c_str()), openni::STATUS_OK) << OpenNI::getExtendedError();
  VideoStream played;
  ASSERT_EQ(played.create(player, openni::SENSOR_DEPTH), openni::STATUS_OK);
  ASSERT_GE(player.getPlaybackControl()->getNumberOfFrames(played), 3);
  ASSERT_EQ(played.start(), openni::STATUS_OK);
  const VideoFrameRef frame = next(played);
  ASSERT_TRUE(frame.isValid());
  EXPECT_EQ(pixels(frame), live);  // nothing moves, and there is no noise
  played.destroy();
  player.close();
}

TEST_F(OpenNi, PlainClientReadsThirtyFrames) {
  EXPECT_EQ(test::ChildProgram({CALIBRD_PLAIN_CLIENT}).wait(std::chrono::seconds(60)), 0);
}

}  // namespace
}  // namespace calibrd::sim
