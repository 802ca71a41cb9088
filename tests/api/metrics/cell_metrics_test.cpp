// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/metrics/cell_metrics.hpp"

#include <gtest/gtest.h>

#include "api/metrics/calibration_metrics.hpp"
#include "tests/api/fake_cell.hpp"

namespace calibrd::api {
namespace {

std::string metrics_of(const FakeCell& cell) {
  MetricsText text;
  write_cell_metrics(cell, text);
  return text.take();
}

void expect_line(const std::string& text, const std::string& line) {
  EXPECT_NE(text.find("\n" + line + "\n"), std::string::npos) << line << "\n" << text;
}

TEST(CellMetrics, TellThePoseOfEverySensor) {
  FakeCell cell;
  cell.make_calibrated();
  const auto text = metrics_of(cell);
  expect_line(text, R"(calibrd_pose_valid{sensor="kinect2"} 1)");
  expect_line(text, R"(calibrd_pose_state{sensor="kinect2",state="calibrated"} 1)");
  expect_line(text, R"(calibrd_pose_state{sensor="kinect2",state="drifted"} 0)");
  expect_line(text, R"(calibrd_pose_sigma_position_meters{sensor="kinect2"} 0.001)");
  expect_line(text, R"(calibrd_sensor_health{sensor="kinect2",health="streaming"} 1)");
}

TEST(CellMetrics, LeaveOutWhatIsNotKnown) {
  FakeCell cell;
  const auto text = metrics_of(cell);
  expect_line(text, R"(calibrd_pose_valid{sensor="kinect2"} 0)");
  for (const auto* absent :
       {"sigma_position_meters{", "calibrated_timestamp_seconds{", "passed_check_age_seconds{"})
    EXPECT_EQ(text.find(std::string("\ncalibrd_pose_") + absent), std::string::npos) << absent;
  EXPECT_EQ(text.find("\ncalibrd_drift_statistic{"), std::string::npos);
}

TEST(CellMetrics, TellDriftAndRobot) {
  FakeCell cell;
  cell.drift_report.watched = true;
  cell.drift_report.now.statistic = 3.5;
  cell.drift_report.now.threshold = 20;
  cell.drift_report.now.verdict = DriftVerdict::sensor_moved;
  cell.robot_report.connects = 3;
  cell.robot_report.joints = JointState{{0.0}, {}, 41, {}};
  const auto text = metrics_of(cell);
  expect_line(text, R"(calibrd_drift_statistic{sensor="kinect2"} 3.5)");
  expect_line(text, R"(calibrd_drift_threshold{sensor="kinect2"} 20)");
  expect_line(text, R"(calibrd_drift_verdict{sensor="kinect2",verdict="sensor_moved"} 1)");
  expect_line(text, "calibrd_robot_connected 1");
  expect_line(text, "calibrd_robot_reconnects_total 2");
  expect_line(text, "calibrd_robot_joint_messages_total 41");
}

TEST(CalibrationMetrics, CountEndsByVerdict) {
  CalibrationMetrics metrics({"kinect2"});
  CalibrationReport report;
  report.sensor_id = "kinect2";
  report.created = std::chrono::system_clock::now();
  metrics.note(report);  // still under way
  report.finished = report.created + std::chrono::seconds(15);
  report.status = JobStatus::succeeded;
  metrics.note(report);
  report.status = JobStatus::failed;
  metrics.note(report);
  report.result = CalibrationResult();
  report.result->verdict = Verdict::uncertain;
  metrics.note(report);
  report.sensor_id = "unheard_of";
  metrics.note(report);
  MetricsText written;
  metrics.write(written);
  const auto text = written.take();
  for (const auto* one : {"succeeded", "failed", "uncertain"})
    expect_line(text, R"(calibrd_calibrations_total{sensor="kinect2",result=")" + std::string(one) + "\"} 1");
  expect_line(text, R"(calibrd_calibrations_total{sensor="kinect2",result="rejected"} 0)");
  expect_line(text, R"(calibrd_calibration_duration_seconds_bucket{sensor="kinect2",le="10"} 0)");
  expect_line(text, R"(calibrd_calibration_duration_seconds_bucket{sensor="kinect2",le="20"} 3)");
}

}  // namespace
}  // namespace calibrd::api
