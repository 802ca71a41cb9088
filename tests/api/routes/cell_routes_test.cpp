// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <boost/json/array.hpp>

#include "tests/api/routes/route_test.hpp"

namespace calibrd::api {
namespace {

using CellRoutes = RouteTest;

TEST_F(CellRoutes, UnknownPathIs404AndWrongMethodIs405WithAllow) {
  EXPECT_EQ(get("/api/v1/sensor").status, 404);
  EXPECT_EQ(code(), "not_found");
  EXPECT_EQ(get("/none").status, 404);
  EXPECT_EQ(ask("DELETE", "/api/v1/sensors/kinect2/calibrations").status, 405);
  EXPECT_EQ(header("Allow"), "POST, GET, HEAD, OPTIONS");
  EXPECT_EQ(ask("OPTIONS", "/api/v1/sensors").status, 204);
}

TEST_F(CellRoutes, SensorsAndOneSensor) {
  cell_.sensor_report.views.refused = {{"moving", 12}};
  cell_.sensor_report.views.timing_error_m = 0.0002;
  cell_.sensor_report.time_offset = {true,       true, Seconds(0.031), Seconds(0.0008), Seconds(0.001),
                                     Seconds(2), ""};
  EXPECT_EQ(get("/api/v1/sensors").status, 200);
  EXPECT_EQ(body().at("sensors").as_array().size(), 1U);
  EXPECT_EQ(get("/api/v1/sensors/kinect2").status, 200);
  EXPECT_EQ(body().at("views").at("frames_refused").at("moving"), 12);
  EXPECT_EQ(body().at("views").at("timing_error_m"), 0.0002);
  EXPECT_EQ(body().at("time_offset").at("source"), "estimated");
  EXPECT_EQ(body().at("time_offset").at("value_s"), 0.031);
  EXPECT_EQ(body().at("time_offset").at("sigma_s"), 0.0008);
  EXPECT_TRUE(body().at("time_offset").at("reason").is_null());
  EXPECT_EQ(get("/api/v1/sensors/none").status, 404);
}

TEST_F(CellRoutes, RobotShowsJointsStampAndLinks) {
  cell_.robot_report.joint_names = {"joint_s"};
  cell_.robot_report.joints = JointState{{0.5}, {}, 7, Clock::time_point(std::chrono::nanoseconds(42))};
  cell_.robot_report.links = {{"tool0", Pose::Identity()}};
  EXPECT_EQ(get("/api/v1/robot").status, 200);
  EXPECT_EQ(body().at("joints").at("stamp_ns"), 42);
  EXPECT_EQ(body().at("joints").at("by_name").at(0).at("name"), "joint_s");
  EXPECT_EQ(body().at("links").at(0).at("name"), "tool0");
}

TEST_F(CellRoutes, RobotBeforeItsFirstMessageHasNoJoints) {
  EXPECT_EQ(get("/api/v1/robot").status, 200);
  EXPECT_TRUE(body().at("joints").is_null());
  EXPECT_TRUE(body().at("controller").is_null());
}

TEST_F(CellRoutes, LostSensorIsNotReadyButAlive) {
  EXPECT_EQ(get("/readyz").status, 200);
  cell_.sensor_report.health = "lost";
  cell_.sensor_report.reason = "unplugged";
  EXPECT_EQ(get("/readyz?verbose").status, 503);
  EXPECT_EQ(body().at("dependencies").at(1).at("reason"), "unplugged");
  EXPECT_EQ(get("/livez").status, 200);
}

TEST_F(CellRoutes, StoreThatCannotBeWrittenIsNotReadyAndSaysWhy) {
  cell_.storage_report = {false, "full", "make room"};
  EXPECT_EQ(get("/readyz?verbose").status, 503);
  EXPECT_EQ(body().at("dependencies").at(2).at("name"), "storage");
  EXPECT_EQ(body().at("dependencies").at(2).at("state"), "full");
  EXPECT_EQ(body().at("dependencies").at(2).at("reason"), "make room");
  cell_.storage_report = {true, "recovered", "look at it"};
  EXPECT_EQ(get("/readyz?verbose").status, 200);
}

TEST_F(CellRoutes, EvidenceOfACalibrationNamesItsViewsWhileTheyAreKept) {
  EXPECT_EQ(get("/api/v1/calibrations/c1").status, 200);
  EXPECT_TRUE(body().at("evidence").is_null());
  EXPECT_EQ(get("/api/v1/calibrations/c1/capture").status, 404);
  EXPECT_EQ(body().at("code"), "capture_not_kept");
  cell_.calibration_report.evidence = Evidence{"0.1", "[robot]", {"joint_s"}, {{2.5, {0.25}}}};
  cell_.calibration_report.capture_bytes = 9;
  cell_.capture_of_calibration = "tar bytes";
  EXPECT_EQ(get("/api/v1/calibrations/c1").status, 200);
  const auto evidence = body().at("evidence");
  EXPECT_EQ(evidence.at("software_version"), "0.1");
  EXPECT_EQ(evidence.at("views").at(0).at("joint_positions_rad").at(0), 0.25);
  EXPECT_EQ(evidence.at("capture").at("bytes"), 9);
  const auto capture = get(std::string(evidence.at("capture").at("path").as_string()));
  EXPECT_EQ(capture.status, 200);
  EXPECT_EQ(capture.body, "tar bytes");
  EXPECT_EQ(get("/api/v1/calibrations/c2/capture").status, 404);
}

TEST_F(CellRoutes, CaptureIsATarDownload) {
  CaptureRequest wanted;
  cell_.on_capture = [&](const CaptureRequest& request) -> Result<CaptureArchive> {
    wanted = request;
    return CaptureArchive{"k.tar", "bytes"};
  };
  const auto response = ask("POST", "/api/v1/sensors/kinect2/captures", R"({"postures": 2, "timeout_s": 5})");
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.text(), "bytes");
  EXPECT_EQ(header("Content-Type"), "application/x-tar");
  EXPECT_EQ(wanted.postures, 2);
  EXPECT_DOUBLE_EQ(wanted.timeout.count(), 5);
  EXPECT_EQ(ask("POST", "/api/v1/sensors/kinect2/captures", R"({"timeout_s": 0})").status, 400);
}

TEST_F(CellRoutes, NextPostureNamesJointsAndWhatToExpect) {
  cell_.make_calibrated();
  cell_.suggestion = {{"joint_s", "joint_l"}, {0.5, -0.25}, 0.0004, 0.0003, 9000, "pan: better"};
  EXPECT_EQ(get("/api/v1/sensors/kinect2/next-posture?table_height_m=-0.5").status, 200);
  EXPECT_EQ(body().at("joint_names").at(1), "joint_l");
  EXPECT_EQ(body().at("positions_rad").at(1), -0.25);
  EXPECT_EQ(body().at("expected").at("sigma_position_m"), 0.0004);
  EXPECT_EQ(body().at("expected").at("sigma_rotation_rad"), 0.0003);
  EXPECT_EQ(body().at("improves"), "pan: better");
  EXPECT_EQ(cell_.last_next_posture.table_height_m, -0.5);
  EXPECT_EQ(get("/api/v1/sensors/none/next-posture").status, 404);
}

TEST_F(CellRoutes, NextPostureWithoutAPoseOrOfABadTableIsRefused) {
  EXPECT_EQ(get("/api/v1/sensors/kinect2/next-posture").status, 409);
  EXPECT_EQ(code(), "no_pose");
  for (const auto* bad : {"high", "", "1m", "nan", "11"}) {
    EXPECT_EQ(get(std::string("/api/v1/sensors/kinect2/next-posture?table_height_m=") + bad).status, 400);
    EXPECT_EQ(code(), "bad_query");
  }
}

TEST_F(CellRoutes, CloudCarriesTheStampOfItsJoints) {
  cell_.cloud_report.frame = "base_link";
  cell_.cloud_report.points = {Eigen::Vector3f(1, 2, 3)};
  cell_.cloud_report.joint_stamp_ns = 123456789;
  cell_.cloud_report.joint_positions_rad = {0.1, -0.2};
  const auto response = get("/api/v1/sensors/kinect2/clouds/virtual?frame=base");
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(header("Calibrd-Joint-Stamp-Ns"), "123456789");
  EXPECT_EQ(header("Calibrd-Joint-Positions"), "0.1 -0.2");
  EXPECT_NE(response.text().find("comment Calibrd-Joint-Stamp-Ns 123456789\n"), std::string::npos);
  const auto header_end = response.text().find("end_header\n") + 11;
  EXPECT_EQ(response.text().size() - header_end, 12U);
  EXPECT_EQ(response.text().substr(header_end, 4), std::string("\0\0\x80\x3f", 4));
  EXPECT_EQ(get("/api/v1/sensors/kinect2/clouds/virtual?frame=world").status, 400);
  EXPECT_EQ(get("/api/v1/sensors/kinect2/clouds/imaginary").status, 404);
}

TEST(Target, IsDecodedOrRefused) {
  const auto target = parse_target("/a%20b/c?x=1&y=%2F+z&flag");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->first, "/a b/c");
  EXPECT_EQ(target->second.at("y"), "/ z");
  EXPECT_TRUE(target->second.contains("flag"));
  EXPECT_FALSE(parse_target("/%e0%80%af"));  // not UTF-8: it could not be quoted in an answer
  EXPECT_EQ(parse_target("/%c3%a9")->first, "/é");
  for (const auto* bad : {"", "a", "/%", "/%g0", "/%00", "/?a=%1", "/%ff", "/%c3", "/?a=%e2%28%a1"})
    EXPECT_FALSE(parse_target(bad)) << bad;
}

}  // namespace
}  // namespace calibrd::api
