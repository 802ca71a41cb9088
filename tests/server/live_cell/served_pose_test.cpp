// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What becomes of an accepted pose: restarts, checks, other configurations, lost sensors.
#include <future>

#include "server/storage/sqlite.hpp"
#include "tests/server/live_cell/cell_fixture.hpp"

namespace calibrd {
namespace {

using api::PoseState;

using ServedPose = CellFixture;

TEST_F(ServedPose, StoredPoseIsUnverifiedAfterARestartUntilACheckAgrees) {
  const auto id = calibrate();
  start();
  EXPECT_EQ(pose().state, PoseState::unverified);
  EXPECT_FALSE(pose().valid);
  EXPECT_EQ(pose().known->calibration_id, id);
  watch_until([&] { return pose().valid; });
  EXPECT_EQ(pose().state, PoseState::calibrated);
}

TEST_F(ServedPose, IsNotGoodWhileWhatWatchesItIsHeldUp) {
  calibrate();
  watch_until([&] { return pose().valid; });
  holds_checks_ = true;
  const int checks = checks_;
  watch_until([&] { return checks_ > checks || !pose().valid; });
  wait_for([&] { return !pose().valid; });
  EXPECT_EQ(pose().state, PoseState::unverified);
  EXPECT_NE(pose().reason, "");
  EXPECT_FALSE(cell_->sensors().at(0).pose_valid);
  holds_checks_ = false;
  watch_until([&] { return pose().valid; });
}

TEST_F(ServedPose, PoseAndRobotNameTheControllerFrame) {
  EXPECT_FALSE(pose().controller_frame);
  EXPECT_EQ(cell_->robot().controller_frame, "");
  settings_.controller_frame = ControllerFrame{"pedestal", Pose(Eigen::Translation3d(0, 0, 0.31))};
  start();
  ASSERT_TRUE(pose().controller_frame);
  EXPECT_EQ(pose().controller_frame->link, "pedestal");
  EXPECT_EQ(pose().controller_frame->T_base_controller.translation().z(), 0.31);
  EXPECT_EQ(cell_->robot().controller_frame, "pedestal");
}

TEST_F(ServedPose, PoseThatNoLongerFitsIsDrifted) {
  calibrate();
  agrees_ = false;
  watch_until([&] { return pose().state == PoseState::drifted; });
  EXPECT_FALSE(pose().valid);
}

TEST_F(ServedPose, DriftThatCannotBeStoredIsAnErrorInTheLog) {
  std::promise<std::string> error;
  on_error_ = [&](const std::string& message) { error.set_value(message); };
  const auto id = calibrate();
  auto database = Database::open(folder_ / "cell.db");
  ASSERT_TRUE(database);
  ASSERT_TRUE(database->run("DROP TABLE drifts", StorageError::cannot_write));
  agrees_ = false;
  watch_until([&] { return pose().state == PoseState::drifted; });
  auto told = error.get_future();
  ASSERT_EQ(told.wait_for(std::chrono::seconds(10)), std::future_status::ready);
  const auto message = told.get();
  EXPECT_NE(message.find("sensor eye"), std::string::npos) << message;
  EXPECT_NE(message.find(id), std::string::npos) << message;
  EXPECT_NE(message.find("drifts"), std::string::npos) << message;
  EXPECT_EQ(pose().state, PoseState::drifted);
}

TEST_F(ServedPose, DriftedPoseIsNotMadeValidByChecksNorByARestart) {
  const auto id = calibrate();
  agrees_ = false;
  watch_until([&] { return pose().state == PoseState::drifted; });
  agrees_ = true;
  expect_checks_change_nothing();
  EXPECT_EQ(pose().state, PoseState::drifted);
  start();
  expect_checks_change_nothing();
  EXPECT_EQ(pose().state, PoseState::drifted);
  ASSERT_TRUE(cell_->activate_calibration(id));
  watch_until([&] { return pose().valid; });
}

TEST_F(ServedPose, StoredPoseOfOtherIntrinsicsStaysInvalidUntilItIsActivated) {
  const auto id = calibrate();
  camera_.fx *= 1.02;
  start();
  expect_checks_change_nothing();
  EXPECT_EQ(pose().state, PoseState::unverified);
  EXPECT_NE(pose().reason.find("intrinsics (now 32x24 fx 30.6"), std::string::npos) << pose().reason;
  EXPECT_EQ(pose().reason.find("robot"), std::string::npos) << pose().reason;
  ASSERT_TRUE(cell_->activate_calibration(id));
  watch_until([&] { return pose().valid; });
  start();
  watch_until([&] { return pose().valid; });
}

TEST_F(ServedPose, StoredPoseOfAnotherRobotModelStaysInvalidUntilACalibration) {
  calibrate();
  std::ofstream(settings_.urdf, std::ios::app) << "<!-- edited -->";
  start();
  expect_checks_change_nothing();
  EXPECT_NE(pose().reason.find("robot model"), std::string::npos) << pose().reason;
  calibrate();
  EXPECT_TRUE(pose().valid);
}

TEST_F(ServedPose, StoredPoseOfUnflippedFramesStaysInvalidForFlippedOnes) {
  calibrate();
  mirror_ = true;
  start();
  expect_checks_change_nothing();
  EXPECT_NE(pose().reason.find("mirror (now true, then false)"), std::string::npos) << pose().reason;
  mirror_ = false;
  start();
  watch_until([&] { return pose().valid; });
}

TEST_F(ServedPose, PoseOfALostSensorIsUnverifiedAtOnceUntilACheckOfALaterFrame) {
  calibrate();
  ASSERT_TRUE(pose().valid);
  set_health(SensorHealth::State::lost);
  wait_for([&] { return !pose().valid; });
  EXPECT_EQ(pose().state, PoseState::unverified);
  expect_checks_change_nothing();
  set_health(SensorHealth::State::streaming);
  watch_until([&] { return pose().valid; });
}

TEST_F(ServedPose, RestartOfTheSensorsProcessIsALossToo) {
  calibrate();
  {
    const std::lock_guard lock(feed_->mutex);
    ++feed_->health.restarts;
  }
  wait_for([&] { return !pose().valid; });
  EXPECT_EQ(pose().state, PoseState::unverified);
  watch_until([&] { return pose().valid; });
}

}  // namespace
}  // namespace calibrd
