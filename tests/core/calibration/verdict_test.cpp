// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/verdict.hpp"

#include "tests/core/calibration/calibrated.hpp"

namespace calibrd {
namespace {

using namespace test;

/// A refinement with nothing to complain about.
Refinement sound() {
  Refinement r;
  r.T_base_sensor = true_T_base_sensor();
  r.covariance = 1e-8 * Matrix6d::Identity();
  r.residual_rms_m = 0.0015;
  r.range.predicted = 10000;
  r.range.measured = 9500;
  r.range.agreeing = 9300;
  r.contour.predicted = 400;
  r.contour.found = 350;
  return r;
}

CalibrationResult judged(const Refinement& refinement, const Evidence& evidence = {}) {
  CalibrationResult result;
  judge(refinement, evidence, {}, result);
  return result;
}

TEST(Verdict, SoundRefinementIsAcceptedWithItsPose) {
  const CalibrationResult result = judged(sound());
  EXPECT_EQ(result.verdict, Verdict::accepted);
  ASSERT_TRUE(result.T_base_sensor);
  EXPECT_TRUE(result.T_base_sensor->isApprox(true_T_base_sensor()));
  EXPECT_TRUE(result.reasons.empty());
  EXPECT_NEAR(result.sigma_position_m, std::sqrt(3e-8), 1e-12);
  EXPECT_NEAR(result.coverage, 0.93, 1e-9);
}

TEST(Verdict, RobotSeenThroughIsRejectedWithoutAPose) {
  Refinement r = sound();
  r.range.seen_through = 4000;
  expect_rejected(judged(r), "free_space_violation");
}

TEST(Verdict, TooFewPixelsAreRejected) {
  Refinement r = sound();
  r.range = {100, 100, 100, 0, 0, {}};
  expect_rejected(judged(r), "too_few_pixels");
}

TEST(Verdict, RobotNotFoundIsRejected) {
  Refinement r = sound();
  r.range.agreeing = 1000;
  expect_rejected(judged(r), "robot_not_found");
}

TEST(Verdict, LargeResidualIsRejected) {
  Refinement r = sound();
  r.residual_rms_m = 0.05;
  expect_rejected(judged(r), "large_residual");
}

TEST(Verdict, OutlineWithoutEdgesIsRejected) {
  Refinement r = sound();
  r.contour.found = 20;
  expect_rejected(judged(r), "contour_not_found");
}

TEST(Verdict, OutlineThatWasNotLookedForIsNoReason) {
  Refinement r = sound();
  r.contour = {};
  EXPECT_EQ(judged(r).verdict, Verdict::accepted);
}

struct Doubt {
  const char* code;
  void (*raise)(Refinement&);
};

void PrintTo(const Doubt& value, std::ostream* out) { *out << value.code; }

class VerdictDoubt : public testing::TestWithParam<Doubt> {};

TEST_P(VerdictDoubt, MakesItUncertainButKeepsThePose) {
  Refinement r = sound();
  GetParam().raise(r);
  const CalibrationResult result = judged(r);
  EXPECT_EQ(result.verdict, Verdict::uncertain) << described(result);
  EXPECT_TRUE(result.T_base_sensor);
  EXPECT_TRUE(has_reason(result, GetParam().code)) << described(result);
}

INSTANTIATE_TEST_SUITE_P(
    , VerdictDoubt,
    testing::Values(
        Doubt{"low_coverage", [](Refinement& r) { r.range.agreeing = 4000; }},
        Doubt{"not_converged", [](Refinement& r) { r.last_step_sigmas = 3; }},
        Doubt{"position_uncertain", [](Refinement& r) { r.covariance.bottomRightCorner<3, 3>() *= 1e4; }},
        Doubt{"rotation_uncertain", [](Refinement& r) { r.covariance.topLeftCorner<3, 3>() *= 1e4; }}),
    [](const auto& test) { return test.param.code; });

}  // namespace
}  // namespace calibrd
