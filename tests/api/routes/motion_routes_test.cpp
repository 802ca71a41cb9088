// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/api/routes/route_test.hpp"

namespace calibrd::api {
namespace {

using MotionRoutes = RouteTest;

constexpr const char* kMotions = "/api/v1/robot/motions";

TEST_F(MotionRoutes, AMotionThatStartsIsAcceptedWithItsPlace) {
  EXPECT_EQ(ask("POST", kMotions, R"({"route": "tour"})").status, 202);
  EXPECT_EQ(header("Location"), "/api/v1/robot/motions/m1");
  EXPECT_EQ(cell_.last_motion.route, "tour");
  EXPECT_TRUE(cell_.last_motion.next_posture_of.empty());
  EXPECT_EQ(body().at("status"), "running");
  EXPECT_EQ(body().at("postures"), 3);
}

TEST_F(MotionRoutes, ASuggestedPostureIsApprovedByItsPositionsOrAsItCame) {
  for (const char* approve : {"[0.1, 0.2]", R"({"positions_rad": [0.1, 0.2], "improves": "tilt"})"}) {
    const auto request = std::string(R"({"next_posture_of": "kinect2", "approve": )") + approve + "}";
    EXPECT_EQ(ask("POST", kMotions, request).status, 202);
    EXPECT_EQ(cell_.last_motion.next_posture_of, "kinect2");
    EXPECT_EQ(cell_.last_motion.approved_rad, (std::vector<double>{0.1, 0.2}));
  }
}

TEST_F(MotionRoutes, WhatIsNotAskedForClearlyIsRefused) {
  for (const char* request : {
           "{}",
           R"({"route": "tour", "next_posture_of": "kinect2", "approve": [0.1]})",
           R"({"next_posture_of": "kinect2"})",
           R"({"next_posture_of": "kinect2", "approve": true})",
           R"({"next_posture_of": "kinect2", "approve": []})",
           R"({"route": "tour", "approve": [0.1]})",
           R"({"route": 7})",
       }) {
    EXPECT_EQ(ask("POST", kMotions, request).status, 400) << request;
    EXPECT_EQ(code(), "bad_value") << request;
  }
  EXPECT_EQ(ask("POST", kMotions, R"({"rout": "tour"})").status, 400);
  EXPECT_EQ(code(), "unknown_key");
  EXPECT_TRUE(cell_.last_motion.route.empty());
}

TEST_F(MotionRoutes, ADaemonThatDoesNotMoveTheRobotSaysSo) {
  cell_.on_motion = [](const auto&) { return fail(ApiError::motion_disabled); };
  EXPECT_EQ(ask("POST", kMotions, R"({"route": "tour"})").status, 403);
  EXPECT_EQ(code(), "motion_disabled");
  EXPECT_NE(body().at("remedy").as_string().find("motion.enabled"), std::string::npos);
}

TEST_F(MotionRoutes, AHindranceIsAConflictThatNamesIt) {
  cell_.on_motion = [](const auto&) { return fail(ApiError::motion_not_possible, "in teach"); };
  EXPECT_EQ(ask("POST", kMotions, R"({"route": "tour"})").status, 409);
  EXPECT_EQ(detail(), "in teach");
}

TEST_F(MotionRoutes, AMotionCanBeReadListedAndStopped) {
  EXPECT_EQ(get("/api/v1/robot/motions/m1").status, 200);
  EXPECT_EQ(get("/api/v1/robot/motions/m2").status, 404);
  EXPECT_EQ(code(), "no_such_motion");
  EXPECT_EQ(get(kMotions).status, 200);
  EXPECT_EQ(body().at("hindrance"), "it moves");
  EXPECT_EQ(body().at("motions").as_array().size(), 1u);
  EXPECT_EQ(ask("DELETE", "/api/v1/robot/motions/m1").status, 200);
  EXPECT_EQ(cell_.stopped, "m1");
}

}  // namespace
}  // namespace calibrd::api
