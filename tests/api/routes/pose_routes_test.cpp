// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/api/routes/route_test.hpp"

namespace calibrd::api {
namespace {

using PoseRoutes = RouteTest;
constexpr const char* kPose = "/api/v1/sensors/kinect2/pose";

TEST_F(PoseRoutes, ValidPoseIsServedWithFramesAndUncertainty) {
  cell_.make_calibrated();
  EXPECT_EQ(get(kPose).status, 200);
  EXPECT_EQ(body().at("valid"), true);
  EXPECT_EQ(body().at("state"), "calibrated");
  EXPECT_EQ(body().at("base_frame"), "base_link");
  EXPECT_EQ(body().at("sensor_frame"), "kinect2_optical");
  EXPECT_EQ(body().at("calibration"), "c1");
  EXPECT_DOUBLE_EQ(body().at("T_base_sensor").at(1).at(3).to_number<double>(), 2);
  EXPECT_DOUBLE_EQ(body().at("sigma_position_m").to_number<double>(), 0.001);
  EXPECT_FALSE(body().contains("last_known"));
}

TEST_F(PoseRoutes, PoseThatIsNotValidIsOnlyLastKnown) {
  cell_.make_calibrated();
  cell_.pose_report.valid = false;
  cell_.pose_report.reason = "not checked for 61 s";
  for (const auto state : {PoseState::calibrated, PoseState::unverified, PoseState::drifted}) {
    cell_.pose_report.state = state;
    EXPECT_EQ(get(kPose).status, 200);
    EXPECT_EQ(body().at("valid"), false);
    EXPECT_FALSE(body().contains("T_base_sensor"));
    EXPECT_FALSE(body().contains("translation_m"));
    EXPECT_TRUE(body().at("last_known").as_object().contains("T_base_sensor"));
    EXPECT_EQ(body().at("reason"), "not checked for 61 s");
  }
}

TEST_F(PoseRoutes, UncalibratedHasNothingLastKnown) {
  EXPECT_EQ(get(kPose).status, 200);
  EXPECT_EQ(body().at("state"), "uncalibrated");
  EXPECT_TRUE(body().at("last_known").is_null());
}

TEST_F(PoseRoutes, FormatsAreLabelled) {
  cell_.make_calibrated();
  EXPECT_EQ(get(std::string(kPose) + "?format=quaternion").status, 200);
  EXPECT_EQ(body().at("order"), "translation x y z, quaternion x y z w");
  EXPECT_DOUBLE_EQ(body().at("rotation_xyzw").at(3).to_number<double>(), 1);
  EXPECT_EQ(get(std::string(kPose) + "?format=matrix").status, 200);
  EXPECT_EQ(body().at("order"), "4x4, row-major");
}

TEST_F(PoseRoutes, UnknownFormatAndParameterNameWhatThereIs) {
  EXPECT_EQ(get(std::string(kPose) + "?format=kuko").status, 400);
  EXPECT_EQ(code(), "unknown_format");
  EXPECT_NE(detail().find("quaternion"), std::string::npos);
  EXPECT_EQ(get(std::string(kPose) + "?fromat=matrix").status, 400);
  EXPECT_NE(detail().find("did you mean 'format'"), std::string::npos);
}

TEST_F(PoseRoutes, UnknownSensorIs404) {
  EXPECT_EQ(get("/api/v1/sensors/other/pose").status, 404);
  EXPECT_EQ(code(), "no_such_sensor");
}

TEST_F(PoseRoutes, SameEtagIsAnswered304WithAges) {
  cell_.make_calibrated();
  get(kPose);
  const auto tag = header("ETag");
  EXPECT_EQ(tag.substr(0, 3), "W/\"");
  const auto again = get(kPose, {{"if-none-match", tag}});
  EXPECT_EQ(again.status, 304);
  EXPECT_TRUE(again.body.empty());
  EXPECT_EQ(header("Calibrd-Passed-Check-Age-S"), "0.500");
  EXPECT_EQ(header("Calibrd-Calibrated-Age-S"), "90.000");
}

TEST_F(PoseRoutes, EtagChangesWithCalibrationStateAndValidity) {
  cell_.make_calibrated();
  get(kPose);
  const auto tag = header("ETag");
  cell_.pose_report.valid = false;
  EXPECT_EQ(get(kPose, {{"if-none-match", tag}}).status, 200);
  cell_.pose_report.valid = true;
  cell_.pose_report.known->calibration_id = "c2";
  EXPECT_EQ(get(kPose, {{"if-none-match", tag}}).status, 200);
}

// A browser that kept the answer would ask with its ETag, which job and candidate are no part of, and show
// old ones.
TEST_F(PoseRoutes, NoCacheMayKeepAnAnswer) {
  get(kPose);
  EXPECT_EQ(header("Cache-Control"), "no-store");
}

TEST_F(PoseRoutes, WaitingIsWorthItOnlyWhileNothingHasChanged) {
  cell_.make_calibrated();
  get(kPose);
  const auto tag = header("ETag");
  EXPECT_EQ(get(std::string(kPose) + "?wait=30s", {{"if-none-match", tag}}).worth_waiting,
            std::chrono::seconds(30));
  EXPECT_EQ(get(std::string(kPose) + "?wait=500ms").worth_waiting, std::chrono::seconds(0));
  cell_.pose_report.valid = false;
  EXPECT_EQ(get(std::string(kPose) + "?wait=30s", {{"if-none-match", tag}}).worth_waiting,
            std::chrono::seconds(0));
  for (const auto* bad : {"30", "61s", "-1s", "s", ""})
    EXPECT_EQ(get(std::string(kPose) + "?wait=" + bad).status, 400) << bad;
}

TEST_F(PoseRoutes, EtagNeverHidesAConflict) {
  cell_.make_calibrated();
  cell_.pose_report.valid = false;
  EXPECT_EQ(get(std::string(kPose) + "?format=matrix", {{"if-none-match", "*"}}).status, 409);
}

}  // namespace
}  // namespace calibrd::api
