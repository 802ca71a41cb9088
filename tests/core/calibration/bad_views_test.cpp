// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "tests/core/calibration/calibrated.hpp"

namespace calibrd {
namespace {

using namespace test;

struct BadViews {
  const char* name;
  void (*spoil)(std::vector<View>&);
  const char* code;
};

void PrintTo(const BadViews& value, std::ostream* out) { *out << value.name; }

class CalibrateBadViews : public testing::TestWithParam<BadViews> {};

TEST_P(CalibrateBadViews, AreRejectedWithAReason) {
  static const std::vector<View> good = [] {
    SceneSettings scene;
    scene.images = true;
    return render_views(2, scene);
  }();
  std::vector<View> views = good;
  GetParam().spoil(views);
  expect_rejected(calibrated(views), GetParam().code);
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
using Views = std::vector<View>;
INSTANTIATE_TEST_SUITE_P(
    , CalibrateBadViews,
    testing::Values(
        BadViews{"None", [](Views& v) { v.clear(); }, "no_views"},
        BadViews{"EmptyFrame", [](Views& v) { std::ranges::fill(v[1].depth.raw, std::uint16_t{0}); },
                 "empty_frame"},
        BadViews{"DepthOfAnotherWidth", [](Views& v) { v[0].depth.width = 511; }, "wrong_image_size"},
        BadViews{"DepthOfAnotherHeight", [](Views& v) { v[1].depth.height = 425; }, "wrong_image_size"},
        BadViews{"DepthPixelsMissing", [](Views& v) { v[1].depth.raw.pop_back(); }, "wrong_image_size"},
        BadViews{"NoDepthPixels", [](Views& v) { v[0].depth.raw.clear(); }, "wrong_image_size"},
        BadViews{"ImageOfAnotherSize", [](Views& v) { v[0].image->width = 256; }, "wrong_image_size"},
        BadViews{"ImagePixelsMissing", [](Views& v) { v[1].image->pixels.clear(); }, "wrong_image_size"},
        BadViews{"JointMissing", [](Views& v) { v[1].joint_positions_rad.pop_back(); }, "wrong_joint_count"},
        BadViews{"JointTooMany", [](Views& v) { v[0].joint_positions_rad.push_back(0); },
                 "wrong_joint_count"},
        BadViews{"NoJoints", [](Views& v) { v[0].joint_positions_rad.clear(); }, "wrong_joint_count"},
        BadViews{"JointNotANumber", [](Views& v) { v[1].joint_positions_rad[3] = kNaN; }, "joint_not_finite"},
        BadViews{"JointInfinite", [](Views& v) { v[0].joint_positions_rad[5] = -kInfinity; },
                 "joint_not_finite"}),
    [](const auto& test) { return test.param.name; });

TEST(CalibrateFrom, GuessHalfAMetreOffIsNotAcceptedUnlessItFindsTheTruth) {
  SceneSettings scene;
  scene.clutter = true;
  const std::vector<View> views = render_views(2, scene);
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const Pose guess = off_by(true_T_base_sensor(), 0.5, 0.1, seed);
    expect_right_or_not_accepted(calibrated(views, scene, guess), 1e-3, 1e-3);
  }
}

TEST(CalibrateFrom, GuessThatLooksAwayIsGivenUpForASearch) {
  Pose away = true_T_base_sensor();
  away.linear() = away.linear() * exp_so3({0, 3.1, 0});
  const CalibrationResult result = calibrated(render_views(2), {}, away);
  expect_accepted_within(result, 2e-3, 2e-3);
  EXPECT_FALSE(result.used_guess);
  EXPECT_EQ(calibrated(render_views(1), {}, away).verdict, Verdict::rejected);  // nothing to search in
}

TEST(CalibrateFrom, RobotOutOfViewIsNotAccepted) {
  SceneSettings scene;
  scene.clutter = true;
  Pose elsewhere = true_T_base_sensor();
  elsewhere.linear() = elsewhere.linear() * exp_so3({0, 1.0, 0});  // the robot is left of the picture
  std::vector<View> views;
  for (const auto& joints : postures(2)) views.push_back(render_view(joints, elsewhere, scene));
  for (const Pose& guess : {elsewhere, true_T_base_sensor()}) {
    const CalibrationResult result = calibrated(views, scene, guess);
    EXPECT_NE(result.verdict, Verdict::accepted) << described(result);
  }
}

TEST(CalibrateFrom, RobotAtThePicturesBorderIsRightOrNotAccepted) {
  SceneSettings scene;
  scene.clutter = true;
  Pose aside = true_T_base_sensor();
  aside.linear() = aside.linear() * exp_so3({0, 0.7, 0});  // little of the robot is left in the picture
  std::vector<View> views;
  for (const auto& joints : postures(2)) views.push_back(render_view(joints, aside, scene));
  for (const Pose& guess : {aside, true_T_base_sensor()}) {
    const CalibrationResult result = calibrated(views, scene, guess);
    if (result.verdict != Verdict::accepted) continue;
    ASSERT_TRUE(result.T_base_sensor);
    const Vector6d error = difference(aside, *result.T_base_sensor);
    EXPECT_LT(error.tail<3>().norm(), 3e-3) << described(result);
    EXPECT_LT(error.head<3>().norm(), 3e-3) << described(result);
  }
}

TEST(CalibrateFrom, EmptySpaceWhereTheRobotShouldBeIsRejected) {
  SceneSettings scene;
  scene.clutter = true;
  // The measured robot stands at other postures than its controller says, half a turn away.
  std::vector<View> views = render_views(2, scene);
  for (View& view : views) view.joint_positions_rad[0] += 3.0;
  for (View& view : views) view.joint_positions_rad[1] += 1.0;
  EXPECT_NE(calibrated(views, scene).verdict, Verdict::accepted);
}

}  // namespace
}  // namespace calibrd
