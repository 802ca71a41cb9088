// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Where a calibration starts from: the request, the last pose, the configured guess, nothing.
#include <tuple>

#include "tests/server/live_cell/cell_fixture.hpp"

namespace calibrd {
namespace {

using api::ApiError;
using api::PoseState;

class StartPose : public CellFixture {
 protected:
  StartPose() {
    on_calibrate_ = [this](auto views, const CalibrationSettings& settings) {
      start_ = settings.guess_T_base_sensor;
      return accepted(views);
    };
  }
  api::CalibrationRequest request(int postures) {
    api::CalibrationRequest request;
    request.sensor_id = "eye";
    request.postures = postures;
    return request;
  }
  /// x of the pose that a calibration of two postures starts from; nothing: it starts from none.
  std::optional<double> start_x(const api::CalibrationRequest& request) {
    const auto started = cell_->start_calibration(request);
    EXPECT_TRUE(started) << started.error().message();
    if (started) move_until_it_ends(started->id);
    return start_ ? std::optional(start_->translation().x()) : std::nullopt;
  }
  void move_until_it_ends(const std::string& id) {
    int step = 0;
    repeat_until(
        [&] {
          stand(0.4 * (++step / 100 % 4));
          show();
        },
        [&] { return job(id).finished.has_value(); });
  }
  void let_it_drift() {
    agrees_ = false;
    watch_until([&] { return pose().state == PoseState::drifted; });
  }
  static constexpr double kLast = 0.3, kConfigured = 0.0;  // x of the pose of accepted(), and of guess_

 private:
  std::optional<Pose> start_;
};

TEST_F(StartPose, IsTheConfiguredGuessThenTheLastPose) {
  EXPECT_EQ(start_x(request(2)), kConfigured);
  EXPECT_EQ(start_x(request(2)), kLast);
}

TEST_F(StartPose, WithoutOneImpatienceWaitsForTheSecondPosture) {
  guess_.reset();
  start();
  auto impatient = request(3);
  impatient.patience = api::Seconds(0.05);
  const auto id = cell_->start_calibration(impatient)->id;
  const auto wanted = Clock::now() + std::chrono::milliseconds(500);
  watch_until([&] { return job(id).postures_seen == 1 && Clock::now() > wanted; });
  EXPECT_EQ(job(id).status, api::JobStatus::collecting);
  move_until_it_ends(id);
  EXPECT_EQ(job(id).result->views, 2);
}

TEST_F(StartPose, ImpatienceWaitsForASecondPostureForAWhile) {
  start();
  auto impatient = request(3);
  impatient.patience = api::Seconds(0.4);
  const auto begin = Clock::now();
  const auto id = cell_->start_calibration(impatient)->id;
  repeat_until(
      [&] {
        stand(0);
        show();
      },
      [&] { return job(id).finished.has_value(); });
  EXPECT_GE(Clock::now() - begin, std::chrono::milliseconds(1000));
  EXPECT_EQ(job(id).result->views, 1);
}

TEST_F(StartPose, WithImpatienceTheResultMustBeMoreCertainToBeAccepted) {
  double sigma_m = 0;
  on_calibrate_ = [&](auto views, const CalibrationSettings&) {
    auto result = accepted(views);
    result.sigma_position_m = sigma_m;
    result.sigma_rotation_rad = 1e-4;
    return result;
  };
  start();
  for (const auto& [sigma, impatient, expected] :
       {std::tuple{0.0015, true, api::JobStatus::succeeded}, std::tuple{0.0025, true, api::JobStatus::failed},
        std::tuple{0.0025, false, api::JobStatus::succeeded}}) {
    sigma_m = sigma;
    auto asked = request(2);
    if (impatient) asked.patience = api::Seconds(60);
    const auto started = cell_->start_calibration(asked);
    ASSERT_TRUE(started);
    move_until_it_ends(started->id);
    EXPECT_EQ(job(started->id).status, expected) << sigma << impatient;
  }
}

TEST_F(StartPose, MayBeALastPoseThatIsNotVerified) {
  calibrate();
  agrees_ = false;
  settings_.watch.least_drift = std::chrono::hours(1);
  start();
  EXPECT_EQ(pose().state, PoseState::unverified);
  EXPECT_EQ(start_x(request(2)), kLast);
}

TEST_F(StartPose, IsNoPoseThatHasDrifted) {
  calibrate();
  let_it_drift();
  EXPECT_EQ(start_x(request(2)), kConfigured);
}

TEST_F(StartPose, IsNoPoseOfAnotherConfiguration) {
  calibrate();
  camera_.fx *= 1.02;
  start();
  EXPECT_EQ(start_x(request(2)), kConfigured);
}

TEST_F(StartPose, IsNothingWhereADriftedPoseIsAllThereIs) {
  calibrate();
  guess_.reset();
  start();
  let_it_drift();
  const auto refused = cell_->start_calibration(request(1));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ApiError::guess_needed);
  EXPECT_EQ(start_x(request(2)), std::nullopt);
}

TEST_F(StartPose, IsNothingWhereTheRequestSaysSo) {
  calibrate();
  auto from_nothing = request(1);
  from_nothing.from_nothing = true;
  EXPECT_EQ(cell_->start_calibration(from_nothing).error().code, ApiError::guess_needed);
  from_nothing.postures = 2;
  EXPECT_EQ(start_x(from_nothing), std::nullopt);
}

TEST_F(StartPose, IsNeededByThePapersMethodHoweverManyPostures) {
  guess_.reset();
  start();
  for (const int postures : {1, 2, 5}) {
    auto by_paper = request(postures);
    by_paper.method = Method::paper;
    const auto refused = cell_->start_calibration(by_paper);
    ASSERT_FALSE(refused) << postures;
    EXPECT_EQ(refused.error().code, ApiError::paper_needs_guess);
    by_paper.guess_T_base_sensor = Pose::Identity();
    const auto started = cell_->start_calibration(by_paper);
    ASSERT_TRUE(started) << started.error().message();
    ASSERT_TRUE(cell_->cancel_calibration(started->id));
  }
}

}  // namespace
}  // namespace calibrd
