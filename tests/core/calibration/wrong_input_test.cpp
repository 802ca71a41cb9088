// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Input that is wrong in a way that people get it wrong. Each is rejected, and told why.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/calibration/calibrate.hpp"
#include "tests/bench/scene.hpp"

namespace calibrd {
namespace {

constexpr std::size_t kViews = 4;

struct Trial {
  std::vector<View> views;
  CameraModel camera;
  const RobotModel* model;
};

struct Robots {
  bench::SceneRobot arm7, arm6;
};

const Robots& robots() {
  static const Robots all{*bench::read_scene_robot(CALIBRD_DEMO_ARM7_URDF, {}),
                          *bench::read_scene_robot(CALIBRD_TEST_ARM6_URDF, {})};
  return all;
}

/// A recording of the demo robot (joints S L E U R B T) in a cell, one view more than is used.
const bench::Scene& good_scene() {
  static const bench::Scene scene = [] {
    sim::CaptureOptions options;
    options.postures = kViews + 1;
    const auto tables = std::make_shared<const sim::SensorTables>(sim::CameraParameters{});
    return *bench::simulate_scene(robots().arm7, 3, options, tables);
  }();
  return scene;
}

Trial good_trial() {
  const bench::Scene& scene = good_scene();
  return {{scene.views.begin(), scene.views.begin() + kViews}, scene.camera, &robots().arm7.model};
}

CalibrationResult calibrated(const Trial& trial) {
  CalibrationSettings settings;
  settings.explaining = std::chrono::minutes(10);  // however busy the computer is
  return calibrate(*trial.model, trial.camera, trial.views, settings);
}

std::string codes_of(const CalibrationResult& result) {
  std::string codes;
  for (const Reason& reason : result.reasons) codes += reason.code + " ";
  return codes;
}

template <class Pixel>
void flip(std::vector<Pixel>& pixels, int width) {
  for (auto row = pixels.begin(); row != pixels.end(); row += width) std::reverse(row, row + width);
}

/// Moves the image right and down.
void move_image(GreyImage& image, int dx, int dy) {
  const GreyImage from = image;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.pixels[static_cast<std::size_t>(y * image.width + x)] = from.pixels[static_cast<std::size_t>(
          std::clamp(y - dy, 0, image.height - 1) * image.width + std::clamp(x - dx, 0, image.width - 1))];
}

struct Mistake {
  const char* name;
  void (*make)(Trial&);
  const char* code;
};

void PrintTo(const Mistake& value, std::ostream* out) { *out << value.name; }

class WrongInput : public testing::TestWithParam<Mistake> {};

TEST(RightInput, IsAcceptedAndTellsWhatSpeaksForIt) {
  const CalibrationResult result = calibrated(good_trial());
  ASSERT_EQ(result.verdict, Verdict::accepted) << codes_of(result);
  EXPECT_LT(difference(good_scene().truth.T_base_sensor, *result.T_base_sensor).tail<3>().norm(), 0.003);
  ASSERT_TRUE(result.held_out_residual_m);
  EXPECT_LT(*result.held_out_residual_m, 0.003);
  ASSERT_TRUE(result.runner_up_margin);
  EXPECT_GT(*result.runner_up_margin, 0.1);
  std::size_t shown = 0;
  for (const LinkCoverage& link : result.links) {
    if (link.predicted < 200) continue;
    ++shown;
    EXPECT_GT(link.coverage, 0.85) << link.link;
  }
  EXPECT_GE(shown, 5U);
}

TEST_P(WrongInput, IsRejectedAndToldWhy) {
  Trial trial = good_trial();
  GetParam().make(trial);
  const CalibrationResult result = calibrated(trial);
  EXPECT_EQ(result.verdict, Verdict::rejected);
  EXPECT_FALSE(result.T_base_sensor);
  EXPECT_TRUE(std::ranges::any_of(result.reasons, [](const Reason& r) { return r.code == GetParam().code; }))
      << codes_of(result);
}

INSTANTIATE_TEST_SUITE_P(, WrongInput,
                         testing::Values(Mistake{"JointsCountedSLURBTE",
                                                 [](Trial& t) {
                                                   for (View& view : t.views) {
                                                     auto& q = view.joint_positions_rad;
                                                     std::rotate(q.begin() + 2, q.begin() + 3, q.end());
                                                   }
                                                 },
                                                 "joint_order_wrong"},
                                         Mistake{"JointTurnsTheOtherWay",
                                                 [](Trial& t) {
                                                   for (View& view : t.views)
                                                     view.joint_positions_rad[2] *= -1;
                                                 },
                                                 "joint_sign_wrong"},
                                         Mistake{"ModelOfAnotherRobot",
                                                 [](Trial& t) {
                                                   t.model = &robots().arm6.model;
                                                   for (View& view : t.views)
                                                     view.joint_positions_rad.pop_back();
                                                 },
                                                 "robot_model_wrong"},
                                         Mistake{"SensorIsMirrored",
                                                 [](Trial& t) {
                                                   for (View& view : t.views) {
                                                     flip(view.depth.raw, view.depth.width);
                                                     flip(view.image->pixels, view.image->width);
                                                   }
                                                 },
                                                 "depth_mirrored"},
                                         Mistake{"FocalLengthsAndCentresSwapped",
                                                 [](Trial& t) {
                                                   std::swap(t.camera.fx, t.camera.fy);
                                                   std::swap(t.camera.cx, t.camera.cy);
                                                 },
                                                 "intrinsics_swapped"},
                                         Mistake{"CentresSwapped",
                                                 [](Trial& t) { std::swap(t.camera.cx, t.camera.cy); },
                                                 "intrinsics_swapped"},
                                         Mistake{"ImageOfAnotherPlace",
                                                 [](Trial& t) {
                                                   for (View& view : t.views) move_image(*view.image, 12, -6);
                                                 },
                                                 "image_not_registered"},
                                         Mistake{"ImageAloneIsMirrored",
                                                 [](Trial& t) {
                                                   for (View& view : t.views)
                                                     flip(view.image->pixels, view.image->width);
                                                 },
                                                 "image_not_registered"},
                                         Mistake{"ImageOfTheNextView",
                                                 [](Trial& t) {
                                                   for (std::size_t v = 0; v + 1 < t.views.size(); ++v)
                                                     t.views[v].image = t.views[v + 1].image;
                                                 },
                                                 "image_not_registered"},
                                         Mistake{"JointsOfTheNextView",
                                                 [](Trial& t) {
                                                   for (std::size_t v = 0; v < t.views.size(); ++v)
                                                     t.views[v].joint_positions_rad =
                                                         good_scene().views[v + 1].joint_positions_rad;
                                                 },
                                                 "joints_not_of_frame"},
                                         Mistake{"RobotMoves",
                                                 [](Trial& t) {
                                                   std::mt19937_64 random(5);
                                                   std::normal_distribution<double> error_rad(0, 0.03);
                                                   for (View& view : t.views)
                                                     for (double& q : view.joint_positions_rad)
                                                       q += error_rad(random);
                                                 },
                                                 "joints_not_of_frame"}),
                         [](const auto& test) { return test.param.name; });

/// Five views, in some of which the robot stood elsewhere than its joints say.
CalibrationResult with_moved_views(std::initializer_list<std::size_t> moved) {
  const bench::Scene& scene = good_scene();
  Trial trial{{scene.views.begin(), scene.views.begin() + kViews + 1}, scene.camera, &robots().arm7.model};
  for (const std::size_t v : moved)
    for (const std::size_t joint : {1U, 3U}) trial.views[v].joint_positions_rad[joint] += 0.05;
  return calibrated(trial);
}

TEST(MovedView, IsLeftOutWhereEnoughOthersAgree) {
  const CalibrationResult result = with_moved_views({2});
  ASSERT_EQ(result.verdict, Verdict::accepted) << codes_of(result);
  EXPECT_NE(codes_of(result).find("view_left_out"), std::string::npos) << codes_of(result);
  EXPECT_EQ(result.views, static_cast<int>(kViews));
  EXPECT_LT(difference(good_scene().truth.T_base_sensor, *result.T_base_sensor).tail<3>().norm(), 2e-3);
}

TEST(CoveredSensor, SpoilsNoCalibrationFromEnoughOtherViews) {
  const bench::Scene& scene = good_scene();
  Trial trial{{scene.views.begin(), scene.views.begin() + kViews + 1}, scene.camera, &robots().arm7.model};
  std::ranges::fill(trial.views[1].depth.raw, std::uint16_t{0});
  const CalibrationResult result = calibrated(trial);
  EXPECT_EQ(result.verdict, Verdict::accepted) << codes_of(result);
  EXPECT_NE(codes_of(result).find("empty_frame"), std::string::npos) << codes_of(result);
}

TEST(MovedView, OfTwoInFiveNoneIsLeftOut) { EXPECT_NE(with_moved_views({1, 3}).verdict, Verdict::accepted); }

TEST(WrongGuess, IsGivenUpForASearch) {
  const Trial trial = good_trial();
  CalibrationSettings settings;
  settings.guess_T_base_sensor = good_scene().truth.T_base_sensor;
  settings.guess_T_base_sensor->translation() += Eigen::Vector3d(0.5, -0.6, 0.3);
  const CalibrationResult result = calibrate(*trial.model, trial.camera, trial.views, settings);
  ASSERT_EQ(result.verdict, Verdict::accepted) << codes_of(result);
  EXPECT_FALSE(result.used_guess);
  const Vector6d error = difference(good_scene().truth.T_base_sensor, *result.T_base_sensor);
  EXPECT_LT(error.tail<3>().norm(), 3e-3);
  EXPECT_LT(error.head<3>().norm(), 3e-3);
}

TEST(OnePosture, WithoutAGuessIsNeverAcceptedAndListsWhereTheSensorMightBe) {
  Trial trial = good_trial();
  trial.views.resize(1);
  const CalibrationResult result = calibrated(trial);
  EXPECT_NE(result.verdict, Verdict::accepted);
  EXPECT_NE(codes_of(result).find("one_view"), std::string::npos) << codes_of(result);
  EXPECT_FALSE(result.hypotheses.empty());
  EXPECT_GT(result.sigma_position_m, 1);  // claims nothing
}

}  // namespace
}  // namespace calibrd
