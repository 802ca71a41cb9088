// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/robot_motions.hpp"

#include "tests/server/live_cell/cell_fixture.hpp"

namespace calibrd {
namespace {

using api::ApiError;
using api::MotionStatus;

/// Takes orders, and does with them what a test says.
class FakeMover : public RobotMover {
 public:
  std::optional<Error> doubt() const override { return doubt_; }
  Status start(MotionOrder order, MotionEvents events) override {
    orders_.push_back(std::move(order));
    events_ = std::move(events);
    if (refusal_) return *refusal_;
    return Done{};
  }
  void stop(MotionError why) override {
    stops_.push_back(why);
    if (ends_when_stopped_ && events_.on_end) events_.on_end({Error{why, {}}});
  }

  std::optional<Error> doubt_, refusal_;
  std::vector<MotionOrder> orders_;
  MotionEvents events_;
  std::vector<MotionError> stops_;
  bool ends_when_stopped_ = true;
};

class RobotMotionsTest : public CellFixture {
 protected:
  RobotMotionsTest() {
    settings_.motion.enabled = true;
    settings_.motion.table_height_m = -5;
    settings_.motion.routes_rad["tour"] = {{0.5, 0.1}, {0.2, -0.1}};
    settings_.motion.routes_rad["beyond"] = {{0.5, 0.1}, {3.1, 0}};
  }
  void SetUp() override {
    CellFixture::SetUp();
    cell_->robot_motions().set_mover(&mover_);
    stand(0.1);
  }
  void TearDown() override {
    cell_->request_stop();
    CellFixture::TearDown();
  }
  Result<api::MotionReport> tour() { return cell_->start_motion({"tour", {}, {}}); }
  std::error_code refusal_of(const api::MotionRequest& request) {
    const auto started = cell_->start_motion(request);
    return started ? std::error_code() : started.error().code;
  }

  FakeMover mover_;
};

TEST_F(RobotMotionsTest, ARouteIsGivenToTheMoverFromWhereTheRobotIs) {
  const auto started = tour();
  ASSERT_TRUE(started) << started.error().message();
  EXPECT_EQ(started->status, MotionStatus::running);
  EXPECT_EQ(started->postures, 2);
  ASSERT_EQ(mover_.orders_.size(), 1u);
  const auto& order = mover_.orders_[0];
  EXPECT_EQ(order.from_rad, (std::vector<double>{0.1, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(order.postures_rad[1], (std::vector<double>{0.2, -0.1, 0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST_F(RobotMotionsTest, TheReportFollowsTheMotionToItsEnd) {
  const auto id = tour()->id;
  mover_.events_.on_command("check motion ready");
  mover_.events_.on_reached(1);
  EXPECT_EQ(cell_->motion(id)->reached, 1);
  EXPECT_EQ(cell_->motion(id)->commands, 1u);
  EXPECT_EQ(refusal_of({"tour", {}, {}}), ApiError::motion_in_progress);
  mover_.events_.on_end({});
  EXPECT_EQ(cell_->motion(id)->status, MotionStatus::succeeded);
  EXPECT_TRUE(cell_->motion(id)->finished);
  EXPECT_EQ(cell_->stop_motion(id).error().code, ApiError::motion_ended);
  EXPECT_TRUE(tour());
  EXPECT_EQ(cell_->motions().motions.size(), 2u);
}

TEST_F(RobotMotionsTest, ADoubtThatEndsItIsAFailureAndAStopIsNone) {
  const auto failed = tour()->id;
  mover_.events_.on_end({Error{MotionError::e_stopped, {}}});
  EXPECT_EQ(cell_->motion(failed)->status, MotionStatus::failed);
  EXPECT_NE(cell_->motion(failed)->message.find("emergency stop"), std::string::npos);
  const auto stopped = tour()->id;
  EXPECT_EQ(cell_->stop_motion(stopped)->status, MotionStatus::stopped);
  EXPECT_EQ(mover_.stops_, std::vector{MotionError::stop_requested});
}

TEST_F(RobotMotionsTest, AStopThatIsBeingMadeShows) {
  mover_.ends_when_stopped_ = false;
  const auto id = tour()->id;
  EXPECT_EQ(cell_->stop_motion(id)->status, MotionStatus::stopping);
  EXPECT_EQ(refusal_of({"tour", {}, {}}), ApiError::motion_in_progress);
}

TEST_F(RobotMotionsTest, TheEndOfTheDaemonStopsItAndNothingStartsAfterwards) {
  ASSERT_TRUE(tour());
  cell_->request_stop();
  EXPECT_EQ(mover_.stops_, std::vector{MotionError::daemon_ends});
  EXPECT_EQ(refusal_of({"tour", {}, {}}), ApiError::shutting_down);
}

TEST_F(RobotMotionsTest, NothingIsGivenToTheMoverThatMustNotBe) {
  EXPECT_EQ(refusal_of({"nowhere", {}, {}}), ApiError::no_such_motion_route);
  EXPECT_EQ(refusal_of({"beyond", {}, {}}), ApiError::way_refused);
  mover_.doubt_ = Error{MotionError::not_automatic, {}};
  EXPECT_EQ(refusal_of({"tour", {}, {}}), ApiError::motion_not_possible);
  EXPECT_NE(cell_->motions().hindrance.find("PLAY"), std::string::npos);
  mover_.doubt_.reset();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(refusal_of({"tour", {}, {}}), ApiError::joints_stale);
  EXPECT_TRUE(mover_.orders_.empty());
}

TEST_F(RobotMotionsTest, WhatTheMoverRefusesIsRefused) {
  mover_.refusal_ = Error{MotionError::not_at_rest, {}};
  EXPECT_EQ(refusal_of({"tour", {}, {}}), ApiError::motion_not_possible);
  mover_.refusal_.reset();
  EXPECT_TRUE(tour());
}

TEST_F(RobotMotionsTest, APostureBelowTheTableIsRefused) {
  settings_.motion.table_height_m = 0;  // the arm lies at 0
  start();
  cell_->robot_motions().set_mover(&mover_);
  stand(0.1);
  EXPECT_EQ(refusal_of({"tour", {}, {}}), ApiError::way_refused);
}

TEST_F(RobotMotionsTest, DisabledMeansThatTheMoverIsNeverAsked) {
  settings_.motion.enabled = false;
  start();
  cell_->robot_motions().set_mover(&mover_);
  stand(0.1);
  EXPECT_EQ(refusal_of({"tour", {}, {}}), ApiError::motion_disabled);
  EXPECT_FALSE(cell_->motions().enabled);
  EXPECT_FALSE(cell_->motions().hindrance.empty());
  EXPECT_TRUE(mover_.orders_.empty());
}

TEST_F(RobotMotionsTest, WithoutAMoverNothingMovesEither) {
  start();
  stand(0.1);
  EXPECT_EQ(refusal_of({"tour", {}, {}}), ApiError::motion_disabled);
}

TEST_F(RobotMotionsTest, OnlyThePostureLastSuggestedForThatSensorCanBeApproved) {
  auto& motions = cell_->robot_motions();
  const std::vector<double> first{0.3, 0.1}, second{0.4, 0.2};
  EXPECT_EQ(refusal_of({{}, "nobody", first}), ApiError::posture_not_suggested);
  EXPECT_EQ(refusal_of({{}, "eye", first}), ApiError::posture_not_suggested);
  PostureSuggestion suggestion;
  suggestion.positions_rad = first;
  motions.remember("eye", suggestion);
  suggestion.positions_rad = second;
  motions.remember("eye", suggestion);
  EXPECT_EQ(refusal_of({{}, "eye", first}), ApiError::posture_not_suggested);
  const auto started = cell_->start_motion({{}, "eye", second});
  ASSERT_TRUE(started) << started.error().message();
  EXPECT_EQ(started->next_posture_of, "eye");
  EXPECT_EQ(mover_.orders_.at(0).postures_rad.at(0)[1], 0.2);
}

}  // namespace
}  // namespace calibrd
