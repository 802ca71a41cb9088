// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/array.hpp>
#include <limits>

#include "tests/api/routes/route_test.hpp"

namespace calibrd::api {
namespace {

using SeveralSensorsRoutes = RouteTest;

const Clock::time_point kStamp{std::chrono::nanoseconds(123456789)};

Obstacle some_obstacle() {
  Obstacle obstacle;
  obstacle.centre_base = {0.5, 0.1, 0.2};
  obstacle.box_base = {Eigen::Vector3d(0.4, 0, 0.1), Eigen::Vector3d(0.6, 0.2, 0.3)};
  obstacle.points = 77;
  obstacle.distance_m = 0.31;
  obstacle.link = 1;
  return obstacle;
}

TEST_F(SeveralSensorsRoutes, ObstaclesSayThatTheyAreNoSafetyFunctionAndNameLinkFrameAndStamps) {
  SensorObstacles seen;
  seen.sensor_id = "kinect2";
  seen.stamp = kStamp;
  seen.joint_positions_rad = {0.1};
  seen.age = Seconds(0.25);
  seen.T_base_sensor = Pose::Identity();
  seen.obstacles = {some_obstacle()};
  cell_.obstacles_report = {"base_link", {"base", "link_2"}, {seen}};
  EXPECT_EQ(get("/api/v1/cell/obstacles").status, 200);
  EXPECT_EQ(body().at("safety_function"), false);
  EXPECT_EQ(body().at("base_frame"), "base_link");
  const boost::json::value sensor = body().at("sensors").at(0);
  EXPECT_EQ(sensor.at("looked"), true);
  EXPECT_EQ(sensor.at("frame_stamp_ns"), 123456789);
  EXPECT_EQ(sensor.at("joint_stamp_ns"), 123456789);
  EXPECT_EQ(sensor.at("age_s"), 0.25);
  const auto& obstacle = sensor.at("obstacles").at(0);
  EXPECT_EQ(obstacle.at("points"), 77);
  EXPECT_EQ(obstacle.at("box_m").at("max").at(0), 0.6);
  EXPECT_EQ(obstacle.at("robot").at("link"), "link_2");
  EXPECT_EQ(obstacle.at("robot").at("distance_m"), 0.31);
}

TEST_F(SeveralSensorsRoutes, ASensorThatCannotLookForObstaclesSaysWhyAndListsNone) {
  SensorObstacles blind;
  blind.sensor_id = "kinect2";
  blind.code = "pose_not_valid";
  blind.reason = "it was knocked";
  cell_.obstacles_report = {"base_link", {}, {blind}};
  EXPECT_EQ(get("/api/v1/cell/obstacles?sensor=kinect2").status, 200);
  const boost::json::value sensor = body().at("sensors").at(0);
  EXPECT_EQ(sensor.at("looked"), false);
  EXPECT_EQ(sensor.at("code"), "pose_not_valid");
  EXPECT_EQ(sensor.at("reason"), "it was knocked");
  EXPECT_TRUE(sensor.at("obstacles").as_array().empty());
  EXPECT_EQ(get("/api/v1/cell/obstacles?sensor=none").status, 404);
  EXPECT_EQ(get("/api/v1/cell/obstacles?sensor=").status, 400);
}

TEST_F(SeveralSensorsRoutes, ObstaclesOfARobotWithoutSurfacesHaveNoDistance) {
  SensorObstacles seen;
  seen.obstacles = {some_obstacle()};
  seen.obstacles.front().link = -1;
  seen.obstacles.front().distance_m = std::numeric_limits<double>::infinity();
  cell_.obstacles_report = {"base_link", {}, {seen}};
  get("/api/v1/cell/obstacles");
  EXPECT_TRUE(body().at("sensors").at(0).at("obstacles").at(0).at("robot").is_null());
}

TEST_F(SeveralSensorsRoutes, MergedCloudCarriesTheSensorOfEachPointAndTheStampsOfEachSensor) {
  EXPECT_EQ(get("/api/v1/cell/cloud").status, 409);
  MergedCloud::Part left{"left", "c1", Pose::Identity(), kStamp, {0.1, -0.2}, 1};
  MergedCloud::Part right{"right", "c2", Pose(Eigen::Translation3d(1, 2, 3)), kStamp, {}, 2};
  cell_.merged_report = {"base_link",
                         {left, right},
                         {{"third", "pose_not_valid", "never calibrated"}},
                         {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}};
  const auto response = get("/api/v1/cell/cloud?robot=false");
  EXPECT_EQ(response.status, 200);
  EXPECT_FALSE(cell_.last_merged.with_robot);
  EXPECT_EQ(header("Calibrd-Frame"), "base_link");
  EXPECT_EQ(header("Calibrd-Sensor-0"), "left");
  EXPECT_EQ(header("Calibrd-Sensor-0-Joint-Positions"), "0.1 -0.2");
  EXPECT_EQ(header("Calibrd-Sensor-1-Frame-Stamp-Ns"), "123456789");
  EXPECT_EQ(header("Calibrd-Sensor-1-Joint-Stamp-Ns"), "");
  EXPECT_EQ(header("Calibrd-Sensor-1-T-Base-Sensor"), "1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1");
  EXPECT_EQ(header("Calibrd-Left-Out"), "third pose_not_valid");
  EXPECT_NE(response.text().find("property uchar sensor\n"), std::string::npos);
  EXPECT_NE(response.text().find("comment Calibrd-Sensor-1 right\n"), std::string::npos);
  const auto first = response.text().find("end_header\n") + 11;
  ASSERT_EQ(response.text().size() - first, 3U * 13U);
  EXPECT_EQ(response.text()[first + 12], '\0');
  EXPECT_EQ(response.text()[first + 25], '\1');
  EXPECT_EQ(response.text()[first + 38], '\1');
  EXPECT_EQ(get("/api/v1/cell/cloud?robot=perhaps").status, 400);
}

TEST_F(SeveralSensorsRoutes, CrossChecksTellAgreementInSigmasAndWhatCouldNotBeCompared) {
  SensorPair agreeing{"left", "right", true, {}}, apart{"left", "top", true, {}};
  agreeing.check.has_overlap = apart.check.has_overlap = true;
  agreeing.check.sigmas = 0.8;
  apart.check.sigmas = std::numeric_limits<double>::infinity();
  cell_.pairs_report = {agreeing, apart, {"right", "top", false, {}}};
  EXPECT_EQ(get("/api/v1/cell/cross-checks").status, 200);
  const boost::json::value pairs = body().at("pairs");
  EXPECT_EQ(pairs.at(0).at("agree"), true);
  EXPECT_EQ(pairs.at(0).at("sigmas"), 0.8);
  EXPECT_EQ(pairs.at(1).at("agree"), false);
  EXPECT_TRUE(pairs.at(1).at("sigmas").is_null());
  EXPECT_EQ(pairs.at(2).at("compared"), false);
  EXPECT_FALSE(pairs.at(2).as_object().contains("agree"));
}

TEST_F(SeveralSensorsRoutes, OneCallStartsTheCalibrationsOfAllAndSaysWhichWereRefused) {
  cell_.refused_starts = {{"other", fail(ApiError::calibration_in_progress, "c7")}};
  EXPECT_EQ(ask("POST", "/api/v1/cell/calibrations").status, 202);
  EXPECT_TRUE(cell_.last_start_all.sensor_ids.empty());
  EXPECT_EQ(body().at("calibrations").at(0).at("location"), "/api/v1/calibrations/c1");
  EXPECT_EQ(body().at("refused").at(0).at("code"), "calibration_in_progress");
  EXPECT_EQ(ask("POST", "/api/v1/cell/calibrations", R"({"sensors": ["a", "b"], "postures": 6})").status,
            202);
  EXPECT_EQ(cell_.last_start_all.sensor_ids, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(cell_.last_start_all.each.postures, 6);
  for (const auto* bad : {R"({"sensors": []})", R"({"sensors": ["a", "a"]})", R"({"sensors": "a"})"})
    EXPECT_EQ(ask("POST", "/api/v1/cell/calibrations", bad).status, 400) << bad;
  EXPECT_EQ(ask("POST", "/api/v1/cell/calibrations", R"({"guess": null})").status, 400);
  EXPECT_EQ(code(), "unknown_key");
}

}  // namespace
}  // namespace calibrd::api
