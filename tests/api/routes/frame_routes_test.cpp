// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <thread>

#include "tests/api/routes/route_test.hpp"

namespace calibrd::api {
namespace {

/// The parts of a stream: length (4 bytes, little-endian) and so many bytes.
std::vector<std::string> parts_of(const std::string& bytes) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at + 4 <= bytes.size();) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i)
      length |= std::size_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
    parts.push_back(bytes.substr(at + 4, length));
    at += 4 + length;
  }
  return parts;
}

class Frames : public RouteTest {
 protected:
  Frames() {
    auto& frame = cell_.frame_report;
    frame.camera.width = 2;
    frame.camera.height = 1;
    frame.depth = {1000, 0x0203};
    frame.predicted = {0, 1234};
    frame.link = {SensorFrame::kNoLink, 3};
    frame.pixel_class = {PixelClass::background, PixelClass::robot};
    frame.stamp = Clock::now();
  }
};

TEST_F(Frames, ArePlaneAfterPlaneBehindWhatTheyWereMadeFrom) {
  const auto answer = get("/api/v1/sensors/kinect2/frames?count=1&step=2");
  ASSERT_TRUE(answer.stream);
  const auto parts = parts_of(answer.stream->next());
  ASSERT_EQ(parts.size(), 2U);
  const auto header = boost::json::parse(parts[0]).as_object();
  EXPECT_EQ(header.at("camera").at("width"), 2);
  EXPECT_TRUE(header.at("T_base_sensor").is_null());
  EXPECT_EQ(parts[1], std::string("\xe8\x03\x03\x02\x00\x00\xd2\x04\xff\x03\x03\x02", 12));
  EXPECT_EQ(cell_.last_frame.step, 2);
  EXPECT_TRUE(answer.stream->has_ended());
}

TEST_F(Frames, AFrameIsSentOnce) {
  const auto answer = get("/api/v1/sensors/kinect2/frames?rate_hz=30");
  EXPECT_FALSE(answer.stream->next().empty());
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_TRUE(answer.stream->next().empty());
  cell_.frame_report.stamp = Clock::now();
  EXPECT_FALSE(answer.stream->next().empty());
  EXPECT_FALSE(answer.stream->has_ended());
}

TEST_F(Frames, WhatIsAskedForMustMakeSense) {
  for (const auto* query : {"step=0", "step=9", "rate_hz=31", "count=0", "step=two", "speed=1"}) {
    get(std::string("/api/v1/sensors/kinect2/frames?") + query);
    EXPECT_EQ(code(), "bad_query") << query;
  }
  get("/api/v1/sensors/nobody/frames");
  EXPECT_EQ(code(), "no_such_sensor");
}

TEST_F(Frames, ALinkHasASurface) {
  const auto mesh = get("/api/v1/robot/links/link_1/mesh");
  EXPECT_EQ(header("Content-Type"), "model/stl");
  EXPECT_EQ(mesh.body.size(), 84U + 50U);
  EXPECT_EQ(mesh.body[80], 1);
  get("/api/v1/robot/links/link_9/mesh");
  EXPECT_EQ(code(), "no_such_link");
}

TEST_F(Frames, JointsGoOnWithoutARobot) {
  const auto stream = get("/api/v1/robot/joints").stream;
  const auto event = stream->next();
  EXPECT_EQ(event.find("event: joints\ndata: {\"positions_rad\": null"), 0U) << event;
  EXPECT_NE(event.find("\"stale\": true"), std::string::npos);
}

TEST_F(Frames, ASessionIsToldWhatItMayDo) {
  get("/api/v1/session");
  EXPECT_EQ(body().at("scope"), "admin");
}

}  // namespace
}  // namespace calibrd::api
