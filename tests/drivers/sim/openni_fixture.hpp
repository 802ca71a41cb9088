// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <OpenNI.h>
#include <gtest/gtest.h>

#include "tests/drivers/sim/child_program.hpp"
#include "tests/drivers/sim/running_world.hpp"

namespace calibrd::sim::test {

using openni::Device;
using openni::OpenNI;
using openni::VideoFrameRef;
using openni::VideoStream;

inline constexpr int kWait_ms = 10'000;
inline constexpr const char* kTwoSensors =
    R"(, "sensors": [{"id": "eye", "position_m": [1.3, 0.2, 0.7], "target_m": [0, 0, 0.4]},
                     {"id": "ear", "position_m": [0, 1.5, 0.7], "target_m": [0, 0, 0.4]}],
        "objects": [{"name": "bench", "box_m": [2, 2, 0.1], "position_m": [0, 0, -0.05]}])";

/// A client of OpenNI2 beside a simulated world of two sensors without errors.
class OpenNi : public testing::Test {
 protected:
  OpenNi() : world_(world_from(kTwoSensors)) { EXPECT_EQ(OpenNI::initialize(), openni::STATUS_OK); }
  ~OpenNi() override {
    depth_.destroy();
    infrared_.destroy();
    device_.close();
    OpenNI::shutdown();
  }

  void open(const char* uri = "calibrd-sim://0") {
    ASSERT_EQ(device_.open(uri), openni::STATUS_OK) << OpenNI::getExtendedError();
    ASSERT_EQ(depth_.create(device_, openni::SENSOR_DEPTH), openni::STATUS_OK);
    ASSERT_EQ(infrared_.create(device_, openni::SENSOR_IR), openni::STATUS_OK);
  }
  void start() {
    ASSERT_EQ(depth_.start(), openni::STATUS_OK);
    ASSERT_EQ(infrared_.start(), openni::STATUS_OK);
  }
  /// The next frame of a stream; an invalid one when none comes in time.
  static VideoFrameRef next(VideoStream& stream, int wait_ms = kWait_ms) {
    VideoStream* streams[] = {&stream};
    int ready = 0;
    VideoFrameRef frame;
    if (OpenNI::waitForAnyStream(streams, 1, &ready, wait_ms) == openni::STATUS_OK) stream.readFrame(&frame);
    return frame;
  }
  static std::vector<std::uint16_t> pixels(const VideoFrameRef& frame) {
    const auto* data = static_cast<const std::uint16_t*>(frame.getData());
    return {data, data + frame.getDataSize() / 2};
  }
  /// What the sensor must have seen at a time.
  Exposure expected(std::int64_t time_ns) {
    SensorModel model(world_.cell(), world_.state().sensors[0].camera);
    return expose(model, world_.state(), 0, time_ns);
  }

  RunningWorld world_;
  Device device_;
  VideoStream depth_, infrared_;
};

}  // namespace calibrd::sim::test
