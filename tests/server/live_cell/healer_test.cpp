// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/healer.hpp"

#include <gtest/gtest.h>

#include "api/problem/api_error.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;

constexpr double kRough_m = 0.002;  // sigma of a pose that should be made better

/// A healer whose calibrations are started by hand-written numbers.
class Healing : public ::testing::Test {
 protected:
  void begin(HealingMode mode, Clock::duration cooldown = 10min) {
    HealerSettings settings;
    settings.mode = mode;
    settings.postures = 2;
    settings.cooldown = cooldown;
    healer_ = std::make_unique<Healer>(
        settings, [this](const auto& request) { return start(request); },
        [this](const auto& id) { cancel(id); }, [this](const auto&) { return last_move_.load(); });
  }
  Result<api::CalibrationReport> start(const api::CalibrationRequest& request) {
    const std::lock_guard lock(mutex_);
    if (busy_ > 0) {
      --busy_;
      return fail(api::ApiError::calibration_in_progress, "c0");
    }
    requests_.push_back(request);
    changed_.notify_all();
    api::CalibrationReport report;
    report.id = "c" + std::to_string(requests_.size());
    return report;
  }
  void cancel(const std::string& id) {
    const std::lock_guard lock(mutex_);
    cancelled_.push_back(id);
    changed_.notify_all();
  }
  bool wait_for(std::size_t requests, Clock::duration patience = 20s) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, patience, [&] { return requests_.size() >= requests; });
  }
  void set_state(api::PoseState state, const std::string& calibration = "c0") {
    api::PoseReport pose;
    pose.sensor_id = "eye";
    pose.state = state;
    pose.known.emplace().calibration_id = calibration;
    healer_->on_pose(pose);
  }
  void end(const std::string& id, api::JobStatus status, bool activate = true, double sigma_m = 1e-4) {
    api::CalibrationReport report;
    report.id = id;
    report.sensor_id = "eye";
    report.status = status;
    report.activate = activate;
    report.current = activate && status == api::JobStatus::succeeded;
    report.result.emplace();
    report.result->sigma_position_m = sigma_m;
    report.result->sigma_rotation_rad = 1e-4;
    report.finished = std::chrono::system_clock::now();
    healer_->on_calibration(report, Clock::now());
  }
  /// The sensor moves, and the first attempt finds its pose.
  void move_and_heal(double sigma_m = 1e-4) {
    const auto attempt = requests_.size() + 1;
    set_state(api::PoseState::drifted);
    ASSERT_TRUE(wait_for(attempt));
    set_state(api::PoseState::calibrated);
    end("c" + std::to_string(attempt), api::JobStatus::succeeded, true, sigma_m);
  }
  /// The sensor moves, and all that is tried without a pause fails.
  void move_and_fail() {
    set_state(api::PoseState::drifted);
    for (std::size_t attempt = 1; attempt <= kWithoutPause; ++attempt) {
      ASSERT_TRUE(wait_for(attempt));
      end("c" + std::to_string(attempt), api::JobStatus::failed);
    }
  }
  static constexpr std::size_t kWithoutPause = 3;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<api::CalibrationRequest> requests_;
  std::vector<std::string> cancelled_;
  int busy_ = 0;
  std::atomic<Clock::time_point> last_move_{Clock::time_point()};
  std::unique_ptr<Healer> healer_;  // last: its thread uses the others
};

TEST_F(Healing, MovedSensorIsCalibratedAtOnceFromWhatIsAtHand) {
  begin(HealingMode::automatic);
  set_state(api::PoseState::calibrated);
  set_state(api::PoseState::drifted);
  ASSERT_TRUE(wait_for(1));
  EXPECT_EQ(requests_[0].sensor_id, "eye");
  EXPECT_EQ(requests_[0].postures, 2);
  EXPECT_TRUE(requests_[0].patience && requests_[0].after_move && requests_[0].activate);
}

TEST_F(Healing, FailedQuickAttemptIsFollowedByAnotherThenAFullOneThenAPause) {
  begin(HealingMode::automatic);
  set_state(api::PoseState::drifted);
  ASSERT_TRUE(wait_for(1));
  end("c1", api::JobStatus::failed);
  ASSERT_TRUE(wait_for(2));
  EXPECT_TRUE(requests_[1].patience && requests_[1].postures);
  end("c2", api::JobStatus::failed);
  ASSERT_TRUE(wait_for(3));
  EXPECT_FALSE(requests_[2].patience || requests_[2].postures);
  end("c3", api::JobStatus::failed);
  EXPECT_FALSE(wait_for(4, 300ms));
}

TEST_F(Healing, SensorThatIsKnockedAgainAndAgainIsNotCalibratedWithoutEnd) {
  begin(HealingMode::automatic);
  for (int knock = 1; knock <= 4; ++knock) ASSERT_NO_FATAL_FAILURE(move_and_heal());
  set_state(api::PoseState::drifted);
  EXPECT_FALSE(wait_for(5, 300ms));
}

TEST_F(Healing, QuickResultThatTellsTooLittleIsFollowedByAFullCalibration) {
  begin(HealingMode::automatic, 0ms);
  ASSERT_NO_FATAL_FAILURE(move_and_heal(kRough_m));
  ASSERT_TRUE(wait_for(2));
  EXPECT_FALSE(requests_[1].patience || requests_[1].postures || requests_[1].after_move);
  end("c2", api::JobStatus::failed);
  EXPECT_FALSE(wait_for(3, 300ms)) << "there is a pose: nothing needs to be tried again";
}

TEST_F(Healing, QuickResultThatIsCertainIsLeftAlone) {
  begin(HealingMode::automatic, 0ms);
  ASSERT_NO_FATAL_FAILURE(move_and_heal());
  EXPECT_FALSE(wait_for(2, 300ms));
}

TEST_F(Healing, SensorThatMovesWhileItsPoseIsMadeBetterIsHealedAtOnce) {
  begin(HealingMode::automatic, 0ms);
  ASSERT_NO_FATAL_FAILURE(move_and_heal(kRough_m));
  ASSERT_TRUE(wait_for(2));
  set_state(api::PoseState::drifted);
  ASSERT_TRUE(wait_for(3));
  EXPECT_EQ(cancelled_, std::vector<std::string>{"c2"});
  EXPECT_TRUE(requests_[2].after_move && requests_[2].patience);
}

TEST_F(Healing, PoseThatSomebodyHasChosenIsNotMadeBetterUnasked) {
  begin(HealingMode::automatic, 300ms);
  for (const bool by_calibration : {true, false}) {
    const auto before = requests_.size();
    ASSERT_NO_FATAL_FAILURE(move_and_heal(kRough_m));
    if (by_calibration)
      end("mine", api::JobStatus::succeeded);
    else
      healer_->on_choice("eye");
    EXPECT_FALSE(wait_for(before + 2, 600ms));
  }
}

TEST_F(Healing, PoseThatSomebodyHasChosenIsNotReplacedByWhatIsUnderWay) {
  begin(HealingMode::automatic, 0ms);
  set_state(api::PoseState::calibrated);
  set_state(api::PoseState::drifted);
  ASSERT_TRUE(wait_for(1));
  healer_->on_choice("eye");
  EXPECT_EQ(cancelled_, std::vector<std::string>{"c1"});
  EXPECT_FALSE(wait_for(2, 300ms));
  set_state(api::PoseState::unverified, "c7");
  set_state(api::PoseState::drifted, "c7");
  EXPECT_TRUE(wait_for(2)) << "where the chosen one has drifted, too, it is healed";
}

TEST_F(Healing, SaysWhenItTriesAgain) {
  begin(HealingMode::automatic);
  EXPECT_FALSE(healer_->next_attempt("eye"));
  ASSERT_NO_FATAL_FAILURE(move_and_fail());
  ASSERT_TRUE(healer_->next_attempt("eye"));
  EXPECT_GT(*healer_->next_attempt("eye"), Clock::now() + 9min);
}

TEST_F(Healing, AskedForTheResultWaitsAsACandidate) {
  begin(HealingMode::ask);
  set_state(api::PoseState::drifted);
  ASSERT_TRUE(wait_for(1));
  EXPECT_FALSE(requests_[0].activate);
  end("c1", api::JobStatus::succeeded, false);
  EXPECT_EQ(healer_->candidate("eye"), "c1");
  EXPECT_FALSE(wait_for(2, 200ms));
  set_state(api::PoseState::calibrated);
  EXPECT_EQ(healer_->candidate("eye"), "");
}

TEST_F(Healing, ACandidateWaitsNoLongerOnceSomebodyHasChosen) {
  begin(HealingMode::ask);
  set_state(api::PoseState::drifted);
  ASSERT_TRUE(wait_for(1));
  end("c1", api::JobStatus::succeeded, false);
  ASSERT_EQ(healer_->candidate("eye"), "c1");
  healer_->on_choice("eye");
  EXPECT_EQ(healer_->candidate("eye"), "");
}

TEST_F(Healing, ACandidateOfBeforeAnotherMoveIsNoneAndAnotherIsFoundAtOnce) {
  begin(HealingMode::ask, 10min);
  set_state(api::PoseState::drifted);
  ASSERT_TRUE(wait_for(1));
  end("c1", api::JobStatus::succeeded, false);
  EXPECT_EQ(healer_->candidate("eye"), "c1");
  last_move_ = Clock::now();
  EXPECT_EQ(healer_->candidate("eye"), "");
  ASSERT_TRUE(wait_for(2));
  EXPECT_FALSE(requests_[1].activate);
  EXPECT_TRUE(requests_[1].patience) << "as after any knock: quickly first";
}

TEST_F(Healing, WhatIsFoundAfterThePoseWasPutRightIsNoCandidate) {
  begin(HealingMode::ask);
  set_state(api::PoseState::drifted);
  ASSERT_TRUE(wait_for(1));
  set_state(api::PoseState::calibrated);
  end("c1", api::JobStatus::succeeded, false);
  EXPECT_EQ(healer_->candidate("eye"), "");
}

TEST_F(Healing, APoseThatHasDriftedBeforeItWasHeardOfIsFoundAgain) {
  begin(HealingMode::automatic);
  set_state(api::PoseState::drifted);
  ASSERT_TRUE(wait_for(1));
  end("c1", api::JobStatus::succeeded);
  set_state(api::PoseState::drifted, "c1");
  ASSERT_TRUE(wait_for(2, 5s)) << "without the pause after an attempt";
}

TEST_F(Healing, OffDoesNothing) {
  begin(HealingMode::off);
  set_state(api::PoseState::drifted);
  EXPECT_FALSE(wait_for(1, 200ms));
}

TEST_F(Healing, CalibrationUnderWayIsWaitedFor) {
  begin(HealingMode::automatic);
  busy_ = 1;
  set_state(api::PoseState::drifted);
  ASSERT_TRUE(wait_for(1));
}

TEST_F(Healing, PoseThatIsGoodAgainEndsTheAttempts) {
  begin(HealingMode::automatic, 200ms);
  ASSERT_NO_FATAL_FAILURE(move_and_fail());
  set_state(api::PoseState::calibrated);
  EXPECT_FALSE(wait_for(kWithoutPause + 1, 500ms));
}

}  // namespace
}  // namespace calibrd
