// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What a calibration saw around the robot is learnt once, and kept with it.
#include <gmock/gmock.h>

#include <future>

#include "tests/server/live_cell/cell_fixture.hpp"

namespace calibrd {
namespace {

class Background : public CellFixture {
 protected:
  Background() {
    watches_ = true;
    camera_ = {160, 120, 150, 150, 79.5, 59.5, {0, 0, 0, 0, 0}};  // coarse cells beside the robot, too
    on_calibrate_ = [](auto views, const auto&) { return accepted(views); };
  }
  bool is_known() {
    stand(0.5);
    show();
    return cell_->drift("eye")->now.has_background;
  }
  /// A calibration that has its views, and whose sensor has moved since.
  std::string move_while_it_is_computed() {
    on_calibrate_ = [until = moved_.get_future().share()](auto views, const auto&) {
      until.wait();
      return accepted(views);
    };
    const auto id = start_job(1)->id;
    watch_until([&] { return job(id).status == api::JobStatus::running; });
    agrees_ = false;
    wall_mm_ = 1700;
    return id;
  }
  void let_it_be_computed(const std::string& id) {
    moved_.set_value();
    wait_for([&] { return job(id).finished.has_value(); });
  }

 private:
  std::promise<void> moved_;
};

TEST_F(Background, OfACurrentCalibrationIsWatchedAtOnceAndStored) {
  const auto id = calibrate();
  wait_for([&] { return is_known(); });
  wait_for([&] { return store_->background(id)->has_value(); });
  start();
  agrees_ = false;  // it is the stored one: none is learnt from frames that pass a check
  wait_for([&] { return is_known(); });
}

TEST_F(Background, OfACandidateIsStoredAndWatchedOnceItIsActivated) {
  const auto id = calibrate_without_activating();
  wait_for([&] { return store_->background(id)->has_value(); });
  start();
  agrees_ = false;
  ASSERT_TRUE(cell_->activate_calibration(id));
  wait_for([&] { return is_known(); });
}

TEST_F(Background, WithoutFramesNothingIsKnownOfNow) {
  calibrate();
  const auto verdict = [&] { return cell_->drift("eye")->now.verdict; };
  repeat_until([&] { is_known(); }, [&] { return verdict() == DriftVerdict::in_place; });
  wait_for([&] { return verdict() == DriftVerdict::no_evidence; });
}

TEST_F(Background, IsAskedBeforeTheRobotOnceTheDaemonIsBack) {
  const auto id = calibrate();
  wait_for([&] { return store_->background(id)->has_value(); });
  start();
  checks_ = 0;
  const auto frames = frames_sent_;
  watch_until([&] { return checks_ > 0; });
  EXPECT_GE(frames_sent_ - frames, 15U);
}

TEST_F(Background, APoseFoundFromViewsOfBeforeAMoveIsNotValidWhenItIsComputed) {
  calibrate();
  repeat_until([&] { is_known(); },
               [&] { return cell_->drift("eye")->now.verdict == DriftVerdict::in_place; });
  const auto id = move_while_it_is_computed();
  watch_until([&] { return cell_->drift("eye")->now.verdict == DriftVerdict::sensor_moved; });
  let_it_be_computed(id);
  EXPECT_EQ(job(id).status, api::JobStatus::succeeded);
  EXPECT_EQ(pose().known->calibration_id, id);
  EXPECT_FALSE(pose().valid);
  EXPECT_EQ(pose().state, api::PoseState::unverified);
}

TEST_F(Background, TheFirstPoseOfASensorThatMovedMeanwhileIsNotValid) {
  const auto id = move_while_it_is_computed();
  const auto frames = frames_sent_;
  watch_until([&] { return frames_sent_ > frames + 5; });
  let_it_be_computed(id);
  EXPECT_EQ(pose().known->calibration_id, id);
  EXPECT_EQ(pose().state, api::PoseState::unverified);
}

TEST_F(Background, OutOfSightThePoseIsUnverifiedUntilItIsSeenAgain) {
  calibrate();
  repeat_until([&] { is_known(); },
               [&] { return cell_->drift("eye")->now.verdict == DriftVerdict::in_place; });
  checks_have_evidence_ = false;
  wall_mm_ = 800;  // somebody stands before the lens
  watch_until([&] { return pose().state == api::PoseState::unverified; });
  EXPECT_THAT(pose().reason, ::testing::HasSubstr("neither the background nor the robot"));
  checks_have_evidence_ = true;
  wall_mm_ = 1500;
  watch_until([&] { return pose().valid; });
}

TEST_F(Background, AfterTheDarkItIsLookedAtBeforeTheRobotIsBelieved) {
  calibrate();
  repeat_until([&] { is_known(); },
               [&] { return cell_->drift("eye")->now.verdict == DriftVerdict::in_place; });
  checks_have_evidence_ = false;
  wall_mm_ = 0;
  watch_until([&] { return pose().state == api::PoseState::unverified; });
  checks_have_evidence_ = true;
  wall_mm_ = 1500;
  const auto frames = frames_sent_;
  watch_until([&] { return pose().valid; });
  EXPECT_GE(frames_sent_ - frames, 10U) << "it may have been moved meanwhile";
}

TEST_F(Background, ThatStaysDarkLeavesTheRobotToTell) {
  calibrate();
  repeat_until([&] { is_known(); },
               [&] { return cell_->drift("eye")->now.verdict == DriftVerdict::in_place; });
  checks_have_evidence_ = false;
  wall_mm_ = 0;
  watch_until([&] { return pose().state == api::PoseState::unverified; });
  checks_have_evidence_ = true;
  watch_until([&] { return pose().valid; });
}

TEST_F(Background, OfARejectedCalibrationIsNone) {
  on_calibrate_ = [](auto, const auto&) { return CalibrationResult(); };
  const auto id = calibrate();
  EXPECT_FALSE(store_->background(id)->has_value());
}

}  // namespace
}  // namespace calibrd
