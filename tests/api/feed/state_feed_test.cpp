// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/feed/state_feed.hpp"

#include <gtest/gtest.h>

#include "tests/api/fake_cell.hpp"

namespace calibrd::api {
namespace {

class Feed : public ::testing::Test {
 protected:
  /// What is new since it was asked last, one line for each event.
  std::string look() {
    feed_.look();
    const auto batch = hub_.after(last_);
    last_ = batch.last;
    std::string all;
    for (const Event& event : batch.events) all += event.type + " " + event.data + "\n";
    return all;
  }

  FakeCell cell_;
  EventHub hub_{"run"};
  StateFeed feed_{cell_, hub_};
  std::optional<std::uint64_t> last_;
};

TEST_F(Feed, TellsTheStateOnceAndThenWhatChanges) {
  const auto first = look();
  for (const char* type : {"robot {", "sensor {", "pose {", "drift {"})
    EXPECT_NE(first.find(type), std::string::npos) << first;
  EXPECT_EQ(look(), "");
  cell_.make_calibrated();
  const auto calibrated = look();
  EXPECT_EQ(calibrated.substr(0, 5), "pose ");
  EXPECT_NE(calibrated.find("\"valid\": true"), std::string::npos) << calibrated;
  EXPECT_EQ(std::count(calibrated.begin(), calibrated.end(), '\n'), 1) << "one event, on one line";
  cell_.robot_report.link_state = "silent";
  EXPECT_EQ(look().substr(0, 6), "robot ");
}

TEST_F(Feed, TellsHowACalibrationGoesOnAndHowItEnds) {
  look();
  cell_.sensor_report.job = "c1";
  cell_.calibration_report.status = JobStatus::collecting;
  cell_.calibration_report.progress = 0.254;
  EXPECT_NE(look().find("\"status\": \"collecting\", \"progress\": 0.25"), std::string::npos);
  cell_.calibration_report.progress = 0.2549;
  EXPECT_EQ(look(), "") << "less than a hundredth";
  cell_.calibration_report.status = JobStatus::failed;
  cell_.calibration_report.message = "too few postures";
  cell_.sensor_report.job = "";
  cell_.sensor_report.ended_job = "c1";
  const auto end = look();
  EXPECT_NE(end.find("\"failed\""), std::string::npos) << end;
  EXPECT_NE(end.find("too few postures"), std::string::npos) << end;
  EXPECT_EQ(look(), "");
}

TEST_F(Feed, TellsTheEndOfACalibrationThatCameAndWentBetweenTwoLooks) {
  look();
  cell_.calibration_report.status = JobStatus::cancelled;
  cell_.sensor_report.ended_job = cell_.calibration_report.id;
  EXPECT_NE(look().find("\"cancelled\""), std::string::npos);
  EXPECT_EQ(look(), "");
}

}  // namespace
}  // namespace calibrd::api
