// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/planning/next_posture.hpp"

#include <cmath>

#include "core/planning/expected_views.hpp"
#include "core/planning/posture_rules.hpp"
#include "tests/core/calibration/calibrated.hpp"

namespace calibrd {
namespace {

using namespace test;
using Posture = std::vector<double>;

/// A calibration from some postures, and what one more makes of it.
struct Situation {
  SceneSettings scene;
  std::vector<Posture> seen;
  std::vector<View> views;
  CalibrationResult result;
  PlanningSettings settings;

  Situation(std::size_t count, std::uint64_t seed, bool images = false) : seen(postures(count)) {
    scene.seed = 77 * seed;
    scene.images = images;
    settings.seed = seed;
    views = render_views(count, scene);
    result = calibrated(views, scene);
  }
  std::optional<PostureSuggestion> suggestion() const {
    return suggest_posture(arm_cell(), scene.camera, *result.T_base_sensor, result.covariance, seen,
                           settings);
  }
  CalibrationResult with(const Posture& posture) const {
    SceneSettings next = scene;
    next.seed = scene.seed + 991;
    auto more = views;
    more.push_back(render_view(posture, true_T_base_sensor(), next));
    return calibrated(more, next);
  }
  /// One of those that are allowed and in view.
  Posture any_posture() const {
    const PostureRules rules(test_arm(), *result.T_base_sensor, seen, settings);
    ExpectedViews expected(arm_cell(), scene.camera, *result.T_base_sensor, result.covariance, seen,
                           settings);
    std::mt19937_64 random(scene.seed);
    for (;;) {
      auto posture = random_posture(test_arm(), settings.limit_margin, random);
      if (rules.allow(posture) && expected.after(posture)) return posture;
    }
  }
  static const VirtualCell& arm_cell() {
    static const VirtualCell cell(test_arm());
    return cell;
  }
};

void expect_within_factor_2(double found, double expected) {
  EXPECT_LT(found, 2 * expected);
  EXPECT_GT(found, expected / 2);
}

void expect_kept_promise(std::size_t count, bool images) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Situation now(count, seed, images);
    ASSERT_TRUE(now.result.T_base_sensor);
    const auto suggestion = now.suggestion();
    ASSERT_TRUE(suggestion);
    EXPECT_LT(suggestion->sigma_position_m, now.result.sigma_position_m);
    const CalibrationResult then = now.with(suggestion->positions_rad);
    expect_within_factor_2(then.sigma_position_m, suggestion->sigma_position_m);
    expect_within_factor_2(then.sigma_rotation_rad, suggestion->sigma_rotation_rad);
  }
}

TEST(NextPosture, KeepsWhatItPromisesAfterOnePosture) { expect_kept_promise(1, false); }
TEST(NextPosture, KeepsWhatItPromisesAfterTwoPostures) { expect_kept_promise(2, false); }
TEST(NextPosture, KeepsWhatItPromisesAfterOnePostureWithImages) { expect_kept_promise(1, true); }
TEST(NextPosture, KeepsWhatItPromisesAfterTwoPosturesWithImages) { expect_kept_promise(2, true); }

TEST(NextPosture, HelpsMoreThanAnyPosture) {
  double suggested = 0, any = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Situation now(2, seed);
    suggested += now.with(now.suggestion()->positions_rad).sigma_position_m;
    any += now.with(now.any_posture()).sigma_position_m;
  }
  EXPECT_LT(suggested, 0.8 * any);
}

TEST(NextPosture, IsWithinLimitsAboveTheTableAndNotSeenBefore) {
  Situation now(2, 5);
  now.settings.min_height_m = 0.15;
  const auto suggestion = now.suggestion();
  ASSERT_TRUE(suggestion);
  EXPECT_EQ(suggestion->joint_names, test_arm().position_names());
  for (const Joint& joint : test_arm().joints()) {
    const double position = suggestion->positions_rad[static_cast<std::size_t>(joint.position_index)];
    EXPECT_GE(position, joint.limits->lower);
    EXPECT_LE(position, joint.limits->upper);
  }
  const auto T_base_link = test_arm().forward_kinematics(suggestion->positions_rad);
  for (std::size_t link = 1; link < T_base_link.size(); ++link)
    for (const auto& vertex : test_arm().links()[link].surface.vertices)
      EXPECT_GT((T_base_link[link] * vertex.cast<double>()).z(), 0.15 - 0.01);
  EXPECT_GT(suggestion->robot_pixels, 2000U);
}

TEST(NextPosture, IsTheSameForTheSameSeed) {
  const Situation now(2, 6);
  EXPECT_EQ(now.suggestion()->positions_rad, now.suggestion()->positions_rad);
}

TEST(NextPosture, NamesTheWeakestDirection) {
  Situation now(2, 7);
  const Eigen::Matrix3d R = now.result.T_base_sensor->linear();
  now.result.covariance = 1e-8 * Matrix6d::Identity();
  now.result.covariance.bottomRightCorner<3, 3>() =
      R * Eigen::Vector3d(1e-8, 1e-8, 4e-6).asDiagonal() * R.transpose();
  const auto suggestion = now.suggestion();
  ASSERT_TRUE(suggestion);
  EXPECT_EQ(suggestion->improves.find("position along the view, seen from the sensor: from 2.00 mm to "), 0U)
      << suggestion->improves;
}

TEST(NextPosture, OfAPoseWithoutPosturesPromisesMoreThanIsKnown) {
  Situation now(2, 8);
  now.seen.clear();
  const auto suggestion = now.suggestion();
  ASSERT_TRUE(suggestion);
  EXPECT_LT(suggestion->sigma_position_m, now.result.sigma_position_m);
  EXPECT_LT(suggestion->sigma_rotation_rad, now.result.sigma_rotation_rad);
}

TEST(NextPosture, IsNoneWhereTheSensorLooksAway) {
  Situation now(2, 9);
  *now.result.T_base_sensor = *now.result.T_base_sensor * Eigen::AngleAxisd(3.1, Eigen::Vector3d::UnitY());
  EXPECT_FALSE(now.suggestion());
}

}  // namespace
}  // namespace calibrd
