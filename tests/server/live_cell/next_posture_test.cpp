// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/server/live_cell/cell_fixture.hpp"

namespace calibrd {
namespace {

/// A sensor that sees enough of the arm.
class NextPosture : public CellFixture {
 protected:
  NextPosture() { camera_ = {128, 96, 250, 250, 63.5, 47.5, {0, 0, 0, 0, 0}}; }
};

CalibrationResult known_to_a_millimetre(CalibrationResult result) {
  result.covariance = 1e-6 * Matrix6d::Identity();
  return result;
}

TEST_F(NextPosture, IsThereOnceAPoseIsKnownAndAfterARestart) {
  on_calibrate_ = [](auto views, const auto&) { return known_to_a_millimetre(accepted(views)); };
  EXPECT_EQ(cell_->next_posture({"none", -1}).error().code, api::ApiError::no_such_sensor);
  EXPECT_EQ(cell_->next_posture({"eye", -1}).error().code, api::ApiError::no_pose);
  calibrate();
  const auto suggestion = cell_->next_posture({"eye", -1});
  ASSERT_TRUE(suggestion) << suggestion.error().message();
  EXPECT_EQ(suggestion->joint_names, model_->position_names());
  EXPECT_LT(suggestion->sigma_position_m, std::sqrt(3e-6));
  start();
  EXPECT_TRUE(cell_->next_posture({"eye", -1}));
}

TEST_F(NextPosture, IsNotChosenFromAPoseThatHasDriftedButFromWhatACalibrationFindsAfterIt) {
  on_calibrate_ = [](auto views, const auto&) { return known_to_a_millimetre(accepted(views)); };
  calibrate();
  ASSERT_TRUE(cell_->next_posture({"eye", -1}));
  agrees_ = false;
  watch_until([&] { return pose().state == api::PoseState::drifted; });
  const auto refused = cell_->next_posture({"eye", -1});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, api::ApiError::calibrate_first);
  start();
  EXPECT_EQ(cell_->next_posture({"eye", -1}).error().code, api::ApiError::calibrate_first);
  on_calibrate_ = [](auto views, const auto&) {
    auto result = known_to_a_millimetre(accepted(views));
    result.verdict = Verdict::uncertain;
    return result;
  };
  calibrate();
  EXPECT_EQ(pose().state, api::PoseState::drifted);
  watch_until([&] { return cell_->next_posture({"eye", -1}).has_value(); });
}

TEST_F(NextPosture, IsNotChosenFromAPoseOfAnotherConfiguration) {
  on_calibrate_ = [](auto views, const auto&) { return known_to_a_millimetre(accepted(views)); };
  calibrate();
  camera_.fx *= 1.02;
  start();
  EXPECT_EQ(cell_->next_posture({"eye", -1}).error().code, api::ApiError::calibrate_first);
}

TEST_F(NextPosture, StaysAboveTheTable) {
  on_calibrate_ = [](auto views, const auto&) { return known_to_a_millimetre(accepted(views)); };
  calibrate();
  EXPECT_EQ(cell_->next_posture({"eye", 0}).error().code, api::ApiError::no_posture);  // the arm lies at 0
}

TEST_F(NextPosture, HelpsAnUncertainCalibrationFurther) {
  on_calibrate_ = [](auto views, const auto&) {
    auto result = known_to_a_millimetre(accepted(views));
    result.verdict = Verdict::uncertain;
    return result;
  };
  calibrate();
  EXPECT_FALSE(pose().known);
  watch_until([&] { return cell_->next_posture({"eye", -1}).has_value(); });
}

}  // namespace
}  // namespace calibrd
