// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/array.hpp>

#include "tests/api/routes/route_test.hpp"

namespace calibrd::api {
namespace {

using DriftRoutes = RouteTest;

TEST_F(DriftRoutes, VerdictStatisticAndSeriesAreShown) {
  auto& drift = cell_.drift_report;
  drift.sensor_id = "kinect2";
  drift.watched = true;
  drift.healing = "ask";
  drift.candidate = "c7";
  drift.healing_in = Seconds(8);
  drift.now.verdict = DriftVerdict::scene_changed;
  drift.now.statistic = 3;
  drift.now.threshold = 11;
  drift.series = {{Clock::now() - std::chrono::seconds(5), 2, 0.001, 0.002, 0.003}};
  drift.events = {{Clock::now() - std::chrono::seconds(7), "scene_changed"}};
  EXPECT_EQ(get("/api/v1/sensors/kinect2/drift").status, 200);
  EXPECT_EQ(body().at("verdict"), "scene_changed");
  EXPECT_EQ(body().at("threshold").to_number<double>(), 11);
  EXPECT_EQ(body().at("candidate"), "c7");
  EXPECT_EQ(body().at("healing_in_s").to_number<double>(), 8);
  EXPECT_NEAR(body().at("series").at(0).at("age_s").to_number<double>(), 5, 2);
  EXPECT_EQ(body().at("events").at(0).at("verdict"), "scene_changed");
  EXPECT_TRUE(body().at("age_s").is_null());
}

TEST_F(DriftRoutes, UnknownSensorAndParameterAreRefused) {
  EXPECT_EQ(get("/api/v1/sensors/none/drift").status, 404);
  EXPECT_EQ(get("/api/v1/sensors/kinect2/drift?last=1").status, 400);
}

}  // namespace
}  // namespace calibrd::api
