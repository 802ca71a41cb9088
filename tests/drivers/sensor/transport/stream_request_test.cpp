// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/transport/stream_request.hpp"

#include <gtest/gtest.h>

#include "drivers/sensor/transport/sensor_error.hpp"

namespace calibrd {
namespace {

StreamRequest usual() {
  StreamRequest request;
  request.width = 512;
  request.height = 424;
  return request;
}

TEST(StreamRequest, TravelsAsArguments) {
  StreamRequest sent = usual();
  sent.device = "freenect2://0?serial=01=2 3";
  sent.speed = 0.3;
  sent.loop = true;
  sent.fps = 15;
  sent.depth_unit_um = 100;
  sent.image = ImageKind::color;
  sent.mirror = true;
  const auto received = request_from_arguments(to_arguments(sent));
  ASSERT_TRUE(received);
  EXPECT_EQ(to_arguments(*received), to_arguments(sent));
  EXPECT_EQ(received->device, sent.device);
  EXPECT_EQ(received->speed, 0.3);
}

TEST(StreamRequest, RefusesArgumentsItDoesNotKnow) {
  for (const char* bad :
       {"--width", "width=3", "--widht=3", "--width=3px", "--width=", "--image=ir", "--loop=yes"}) {
    const std::string argument = bad;
    const auto parsed = request_from_arguments(std::span(&argument, 1));
    ASSERT_FALSE(parsed) << bad;
    EXPECT_NE(parsed.error().detail.find(bad), std::string::npos) << parsed.error().detail;
  }
}

TEST(StreamRequest, NamesTheSettingThatCannotWork) {
  const auto expect_refused = [](const StreamRequest& request, const std::string& key) {
    const auto checked = check(request);
    ASSERT_FALSE(checked) << key;
    EXPECT_EQ(checked.error().code, SensorError::invalid_settings);
    EXPECT_EQ(checked.error().detail.rfind(key, 0), 0u) << checked.error().detail;
  };
  EXPECT_TRUE(check(usual()));
  StreamRequest r = usual();
  r.width = 0;
  expect_refused(r, "width");
  r = usual();
  r.height = 100000;
  expect_refused(r, "height");
  r = usual();
  r.fps = -1;
  expect_refused(r, "fps");
  r = usual();
  r.depth_unit_um = 10;
  expect_refused(r, "depth_unit_um");
  r = usual();
  r.speed = 0;
  expect_refused(r, "speed");
  r = usual();
  r.device = std::string("a");  // GCC 12 misreads a plain literal here (-Wrestrict)
  r.recording = std::string("b.oni");
  expect_refused(r, "recording");
}

}  // namespace
}  // namespace calibrd
