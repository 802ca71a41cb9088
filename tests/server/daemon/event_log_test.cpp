// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/event_log.hpp"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <sstream>

namespace calibrd {
namespace {

/// The log in a string, each line as "level message".
class EventLog : public ::testing::Test {
 protected:
  void SetUp() override {
    auto logger =
        std::make_shared<spdlog::logger>("t", std::make_shared<spdlog::sinks::ostream_sink_st>(lines_));
    logger->set_pattern("%l %v");
    spdlog::set_default_logger(std::move(logger));
  }
  std::ostringstream lines_;

 private:
  struct Restore {
    std::shared_ptr<spdlog::logger> before = spdlog::default_logger();
    ~Restore() { spdlog::set_default_logger(before); }
  } restore_;
};

TEST_F(EventLog, CalibrationThatLosesItsPosturesIsAWarning) {
  api::CalibrationReport report;
  report.id = "c1";
  report.sensor_id = "eye";
  report.status = api::JobStatus::collecting;
  report.message = "0 of 3 postures";
  log_calibration(report);
  EXPECT_EQ(lines_.str(), "warning sensor eye: calibration c1 collecting. 0 of 3 postures\n");
}

TEST_F(EventLog, ErrorsAreLoggedAsSuch) {
  log_error("the disk is full");
  EXPECT_EQ(lines_.str(), "error the disk is full\n");
}

}  // namespace
}  // namespace calibrd
