// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/live_cell.hpp"

#include "tests/server/live_cell/cell_fixture.hpp"

namespace calibrd {
namespace {

using api::ApiError;
using api::JobStatus;
using api::PoseState;
using namespace std::chrono_literals;

using Cell = CellFixture;

TEST_F(Cell, SensorThatWasNeverCalibratedHasNoPose) {
  EXPECT_EQ(pose().state, PoseState::uncalibrated);
  EXPECT_FALSE(pose().valid);
  EXPECT_FALSE(pose().known);
  EXPECT_EQ(cell_->pose("other").error().code, ApiError::no_such_sensor);
}

TEST_F(Cell, AcceptedCalibrationBecomesThePose) {
  const auto started = start_job(3);
  ASSERT_TRUE(started);
  EXPECT_EQ(started->status, JobStatus::collecting);
  EXPECT_EQ(pose().job, started->id);
  let_it_end(started->id);
  const auto ended = job(started->id);
  EXPECT_EQ(ended.status, JobStatus::succeeded);
  EXPECT_TRUE(ended.current);
  EXPECT_EQ(ended.result->views, 3);
  EXPECT_EQ(ended.postures_seen, 3);
  EXPECT_TRUE(pose().valid);
  EXPECT_EQ(pose().known->calibration_id, started->id);
  EXPECT_EQ(pose().job, "");
}

TEST_F(Cell, RejectedCalibrationLeavesThePoseAsItWas) {
  const auto good = calibrate();
  on_calibrate_ = [](auto, const auto&) {
    CalibrationResult result;
    result.reasons = {{"few_pixels", "the robot is hardly in view"}};
    return result;
  };
  const auto bad = *start_job(1);
  let_it_end(bad.id);
  EXPECT_EQ(job(bad.id).status, JobStatus::failed);
  EXPECT_NE(job(bad.id).message.find("hardly in view"), std::string::npos);
  EXPECT_EQ(pose().known->calibration_id, good);
  EXPECT_EQ(cell_->activate_calibration(bad.id).error().code, ApiError::not_activatable);
}

TEST_F(Cell, UncertainCalibrationIsNeverServed) {
  on_calibrate_ = [](auto views, const auto&) {
    auto result = accepted(views);
    result.verdict = Verdict::uncertain;
    return result;
  };
  const auto id = start_job(1)->id;
  let_it_end(id);
  EXPECT_EQ(job(id).status, JobStatus::failed);
  EXPECT_TRUE(job(id).result->T_base_sensor);
  EXPECT_EQ(pose().state, PoseState::uncalibrated);
  EXPECT_EQ(cell_->activate_calibration(id).error().code, ApiError::not_activatable);
}

TEST_F(Cell, ExceptionInTheComputationFailsTheCalibrationOnly) {
  on_calibrate_ = [](auto, const auto&) -> CalibrationResult { throw std::runtime_error("boom"); };
  const auto id = start_job(1)->id;
  let_it_end(id);
  EXPECT_EQ(job(id).status, JobStatus::failed);
  EXPECT_NE(job(id).message.find("boom"), std::string::npos);
}

TEST_F(Cell, CalibrationThatIsNotToBeActivatedCanBeLater) {
  const auto first = calibrate();
  const auto second = calibrate_without_activating();
  EXPECT_EQ(job(second).status, JobStatus::succeeded);
  EXPECT_EQ(pose().known->calibration_id, first);
  agrees_ = false;
  ASSERT_TRUE(cell_->activate_calibration(second));
  EXPECT_EQ(pose().known->calibration_id, second);
  EXPECT_FALSE(pose().valid);
  agrees_ = true;
  watch_until([&] { return pose().valid; });
  EXPECT_TRUE(job(second).current);
  EXPECT_FALSE(job(first).current);
}

TEST_F(Cell, OneCalibrationOfASensorAtATime) {
  const auto first = start_job(2);
  const auto second = start_job(2);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ApiError::calibration_in_progress);
  EXPECT_EQ(second.error().detail, first->id);
}

TEST_F(Cell, IdempotencyKeyStartsOneCalibrationAlsoAcrossARestart) {
  const auto first = start_job(1, "k");
  EXPECT_EQ(start_job(1, "k")->id, first->id);
  EXPECT_EQ(start_job(2, "k").error().code, ApiError::idempotency_conflict);
  let_it_end(first->id);
  start();
  EXPECT_EQ(start_job(1, "k")->id, first->id);
}

TEST_F(Cell, CalibrationCanBeCancelledWhileItCollects) {
  const auto id = start_job(5)->id;
  EXPECT_EQ(cell_->cancel_calibration(id)->status, JobStatus::cancelled);
  EXPECT_EQ(cell_->cancel_calibration(id).error().code, ApiError::calibration_not_running);
  EXPECT_EQ(cell_->cancel_calibration("none").error().code, ApiError::no_such_calibration);
  EXPECT_TRUE(start_job(1));
}

TEST_F(Cell, CalibrationCanBeCancelledWhileItComputes) {
  on_calibrate_ = [](auto views, const CalibrationSettings& settings) {
    while (!settings.cancelled->load()) std::this_thread::yield();
    return accepted(views);
  };
  const auto id = start_job(1)->id;
  watch_until([&] { return job(id).status == JobStatus::running; });
  ASSERT_TRUE(cell_->cancel_calibration(id));
  wait_for([&] { return job(id).status == JobStatus::cancelled; });
  EXPECT_FALSE(pose().known);
}

TEST_F(Cell, CancelThatComesWhileTheEndIsBeingStoredIsTooLateAndSaysSo) {
  std::optional<Error> refused;
  on_log_ = [&](const api::CalibrationReport& report) {  // between the store and the end of the job
    if (!report.finished) return;
    const auto answer = cell_->cancel_calibration(report.id);
    if (!answer) refused = answer.error();
  };
  calibrate();
  wait_for([&] { return !cell_->cancel_calibration("none").has_value(); });
  on_log_ = [](const auto&) {};
  ASSERT_TRUE(refused) << "it is told that it was in time, and the pose is served all the same";
  EXPECT_EQ(refused->code, ApiError::calibration_not_running);
}

TEST_F(Cell, CalibrationThatDoesNotSeeItsPosturesFailsAndSaysWhy) {
  settings_.jobs.collect_timeout = 300ms;
  start();
  const auto id = start_job(2)->id;
  watch_until([&] { return job(id).finished.has_value(); });
  EXPECT_EQ(job(id).status, JobStatus::failed);
  EXPECT_NE(job(id).message.find("1 of 2 postures"), std::string::npos) << job(id).message;
}

TEST_F(Cell, LastPoseIsTheGuessOfTheNextCalibration) {
  std::vector<double> guesses_x;
  on_calibrate_ = [&](auto views, const CalibrationSettings& settings) {
    guesses_x.push_back(settings.guess_T_base_sensor->translation().x());
    return accepted(views);
  };
  calibrate();
  calibrate();
  EXPECT_EQ(guesses_x, (std::vector<double>{0.0, 0.3}));
}

TEST_F(Cell, WithoutAGuessTwoPosturesAreCollectedAndOneIsRefused) {
  guess_.reset();
  settings_.jobs.collector.postures = 1;
  start();
  const auto refused = start_job(1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ApiError::guess_needed);
  bool guessed = true;
  on_calibrate_ = [&](auto views, const CalibrationSettings& settings) {
    guessed = settings.guess_T_base_sensor.has_value();
    return accepted(views);
  };
  api::CalibrationRequest request;
  request.sensor_id = "eye";
  const auto id = cell_->start_calibration(request)->id;
  EXPECT_EQ(job(id).postures_wanted, 2);
  let_it_end(id);
  EXPECT_EQ(job(id).status, JobStatus::succeeded);
  EXPECT_FALSE(guessed);
  EXPECT_TRUE(start_job(1)) << "the last pose is a guess";
}

TEST_F(Cell, LatencyOfTheLinkIsTakenOffTheStampsOfJoints) {
  settings_.joint_latency = 10ms;
  start();
  const auto arrived = Clock::now();
  events_.on_joints({0, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, {}, ++joints_sent_, arrived});
  EXPECT_EQ(cell_->robot().joints->stamp, arrived - 10ms);
}

TEST_F(Cell, MovingRobotGivesNoViewsAndTheReasonIsShown) {
  double turn = 0;
  repeat_until(
      [&] {
        events_.on_joints({0, {turn += 0.01, 0, 0, 0, 0, 0, 0, 0, 0, 0}, {}, ++joints_sent_, Clock::now()});
        show();
      },
      [&] { return cell_->sensor("eye")->views.code == "moving"; });
  EXPECT_EQ(cell_->sensor("eye")->views.views, 0U);
  EXPECT_FALSE(cell_->sensor("eye")->views.reason.empty());
  EXPECT_FALSE(cell_->robot().still);
}

TEST_F(Cell, SilentRobotGivesNoViews) {
  repeat_until([&] { show(); }, [&] { return cell_->sensor("eye")->views.code == "no_joints"; });
  EXPECT_TRUE(cell_->robot().joints_stale);
}

TEST_F(Cell, FramesOfAnotherSizeAreRefused) {
  repeat_until(
      [&] {
        DepthFrame frame;
        frame.depth = {16, 24, 0.001, std::vector<std::uint16_t>(16 * 24, 1500)};
        frame.sequence = ++frames_sent_;
        frame.stamp = Clock::now();
        const std::lock_guard lock(feed_->mutex);
        feed_->frames.push_back(std::move(frame));
        feed_->changed.notify_all();
      },
      [&] { return cell_->sensor("eye")->views.code == "wrong_size"; });
}

TEST_F(Cell, HistoryShowsTheCalibrationUnderWayAsItIs) {
  const auto id = start_job(2)->id;
  const auto page = cell_->history({"eye", 10, ""});
  ASSERT_TRUE(page);
  EXPECT_EQ(page->calibrations.front().id, id);
  EXPECT_EQ(page->calibrations.front().status, JobStatus::collecting);
}

TEST_F(Cell, CollectsNothingMoreWhileItComputes) {
  std::atomic<bool> may_end{false};
  on_calibrate_ = [&](auto views, const CalibrationSettings&) {
    while (!may_end) std::this_thread::yield();
    return accepted(views);
  };
  const auto id = start_job(2)->id;
  repeat_until(
      [&] {
        stand(0.3 * (1 + job(id).postures_seen));
        show();
      },
      [&] { return job(id).status == JobStatus::running; });
  const auto views = cell_->sensor("eye")->views.views;
  repeat_until(
      [&] {
        stand(1.5);
        show();
      },
      [&] { return cell_->sensor("eye")->views.views > views + 3; });
  EXPECT_EQ(job(id).postures_seen, 2);
  may_end = true;
  wait_for([&] { return job(id).finished.has_value(); });
  EXPECT_EQ(job(id).postures_seen, 2);
}

/// For the thread sanitizer.
TEST_F(Cell, SensorCanBeAskedForWhileItStarts) {
  std::atomic<bool> asking{true};
  ASSERT_TRUE(cell_->add_sensor({"late", camera_, Clock::duration(0), guess_}));
  std::thread client([&] {
    while (asking) EXPECT_FALSE(cell_->sensor("late")->health.empty());
  });
  cell_->start("late", std::make_unique<FedSource>(std::make_shared<FedSource::Feed>()));
  wait_for([&] { return cell_->sensor("late")->health == "streaming"; });
  asking = false;
  client.join();
}

TEST_F(Cell, HistoryBeforeACalibrationThatIsNotThereIsRefused) {
  const auto id = calibrate();
  EXPECT_TRUE(cell_->history({"eye", 10, id}));
  const auto refused = cell_->history({"eye", 10, "nope"});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ApiError::bad_query);
  EXPECT_NE(refused.error().detail.find("nope"), std::string::npos);
}

TEST_F(Cell, EndsAtOnceWhileCollecting) {
  ASSERT_TRUE(start_job(5));
  const auto begin = Clock::now();
  cell_.reset();
  EXPECT_LT(Clock::now() - begin, 800ms);
}

}  // namespace
}  // namespace calibrd
