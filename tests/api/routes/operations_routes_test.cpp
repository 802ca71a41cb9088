// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/api/routes/route_test.hpp"

namespace calibrd::api {
namespace {

using OperationsRoutes = RouteTest;

TEST_F(OperationsRoutes, MetricsAreTextOfPrometheus) {
  EXPECT_EQ(get("/metrics").body, "# HELP a b\n");
  EXPECT_EQ(header("Content-Type"), "text/plain; version=0.0.4; charset=utf-8");
  EXPECT_EQ(get("/metrics?x=1").status, 400);
}

TEST_F(OperationsRoutes, ALostSensorIsNotADeadProcess) {
  cell_.sensor_report.health = "lost";
  cell_.sensor_report.reason = "unplugged";
  EXPECT_EQ(get("/readyz?verbose").status, 503);
  EXPECT_EQ(body().at("dependencies").at(1).at("reason"), "unplugged");
  EXPECT_EQ(get("/livez").status, 200);
}

TEST_F(OperationsRoutes, AThreadThatHangsIsNeitherAliveNorReady) {
  EXPECT_EQ(get("/readyz").status, 200);
  operations_.stalled = {"sensor kinect2"};
  EXPECT_EQ(get("/livez").status, 503);
  EXPECT_NE(std::string(body().at("reason").as_string()).find("sensor kinect2"), std::string::npos);
  EXPECT_EQ(get("/readyz?verbose").status, 503);
  EXPECT_EQ(body().at("dependencies").at(3).at("state"), "stalled");
}

TEST_F(OperationsRoutes, TheSupportBundleIsAFileToSave) {
  EXPECT_EQ(get("/api/v1/support_bundle").body, "tar bytes");
  EXPECT_EQ(header("Content-Type"), "application/x-tar");
  EXPECT_EQ(header("Content-Disposition"), "attachment; filename=\"calibrd-support.tar\"");
}

}  // namespace
}  // namespace calibrd::api
