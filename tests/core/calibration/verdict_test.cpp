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

struct Fault {
  const char* code;
  void (*raise)(Refinement&);
};

void PrintTo(const Fault& value, std::ostream* out) { *out << value.code; }

class VerdictFault : public testing::TestWithParam<Fault> {};

TEST_P(VerdictFault, RejectsWithoutAPose) {
  Refinement r = sound();
  GetParam().raise(r);
  expect_rejected(judged(r), GetParam().code);
}

INSTANTIATE_TEST_SUITE_P(
    , VerdictFault,
    testing::Values(Fault{"free_space_violation", [](Refinement& r) { r.range.seen_through = 4000; }},
                    Fault{"too_few_pixels", [](Refinement& r) { r.range = {100, 100, 100, 0, 0, {}}; }},
                    Fault{"robot_not_found", [](Refinement& r) { r.range.agreeing = 1000; }},
                    Fault{"large_residual", [](Refinement& r) { r.residual_rms_m = 0.05; }},
                    Fault{"contour_not_found", [](Refinement& r) { r.contour.found = 20; }}),
    [](const auto& test) { return test.param.code; });

TEST(Verdict, OutlineThatWasNotLookedForIsNoReason) {
  Refinement r = sound();
  r.contour = {};
  EXPECT_EQ(judged(r).verdict, Verdict::accepted);
}

/// Four views and two links, all as predicted.
Evidence sound_evidence() {
  const SurfaceTally good{1000, 980, 970, 2, 8};
  Evidence evidence;
  evidence.links = {good, good};
  evidence.views.assign(4, good);
  evidence.joint_pull_m.assign(4, 2e-4);
  evidence.held_out_residual_m = 0.0013;
  evidence.images = {800, 0.7, 0.4, 4, 0, 0, 0};
  return evidence;
}

CalibrationResult judged_with(const Evidence& evidence, const Refinement& refinement = sound()) {
  CalibrationResult result;
  result.links = {{"link_1", 1000, 0.97}, {"link_2", 1000, 0.97}};
  judge(refinement, evidence, {}, result);
  return result;
}

TEST(Verdict, SoundEvidenceLeavesItAccepted) {
  const auto result = judged_with(sound_evidence());
  EXPECT_EQ(result.verdict, Verdict::accepted) << described(result);
  EXPECT_TRUE(result.reasons.empty());
}

struct Contradiction {
  const char* name;
  const char* code;
  void (*raise)(Evidence&);
  const char* in_text;
};

void PrintTo(const Contradiction& value, std::ostream* out) { *out << value.name; }

class VerdictContradiction : public testing::TestWithParam<Contradiction> {};

TEST_P(VerdictContradiction, RejectsWithItsReason) {
  Evidence evidence = sound_evidence();
  GetParam().raise(evidence);
  const auto result = judged_with(evidence);
  expect_rejected(result, GetParam().code);
  ASSERT_FALSE(result.reasons.empty());
  EXPECT_NE(result.reasons.front().text.find(GetParam().in_text), std::string::npos)
      << result.reasons.front().text;
}

INSTANTIATE_TEST_SUITE_P(
    , VerdictContradiction,
    testing::Values(
        Contradiction{"JointsPull", "views_disagree",
                      [](Evidence& e) { e.joint_pull_m[1] = e.joint_pull_m[3] = 0.004; }, "1, 3"},
        Contradiction{"ViewSeenThrough", "views_disagree",
                      [](Evidence& e) {
                        e.views[2] = {1000, 980, 500, 480, 0};
                      },
                      "view 2"},
        Contradiction{"ViewEmpty", "views_disagree",
                      [](Evidence& e) {
                        e.views[0] = {1000, 300, 280, 0, 20};
                      },
                      "view 0"},
        Contradiction{"HeldOut", "held_out_disagrees", [](Evidence& e) { e.held_out_residual_m = 0.004; },
                      "4.00 mm"},
        Contradiction{"LinkElsewhere", "link_elsewhere",
                      [](Evidence& e) {
                        e.links[1] = {1000, 900, 100, 800, 0};
                      },
                      "link_2"},
        Contradiction{"ImageShifted", "image_not_registered",
                      [](Evidence& e) { e.images = {800, 0.3, 0.7, 12, -6, 0.2, 0.3}; }, "12 px"},
        Contradiction{"ImageMirrored", "image_not_registered",
                      [](Evidence& e) { e.images = {800, 0.2, 0.3, 12, -6, 0.7, 0.3}; }, "mirrored"},
        Contradiction{"ImageOfAnotherView", "image_not_registered",
                      [](Evidence& e) { e.images = {800, 0.4, 0.3, 12, -6, 0.2, 0.6}; }, "another view"},
        Contradiction{"OutlineOnNoEdge", "image_not_registered",
                      [](Evidence& e) { e.images = {800, 0.2, 0.2, 12, -6, 0.2, 0.2}; }, "does not show"}),
    [](const auto& test) { return test.param.name; });

TEST(Verdict, OneViewOfManyAtOddsIsADoubtThatNamesIt) {
  Evidence evidence = sound_evidence();
  evidence.views.assign(10, evidence.views.front());
  evidence.joint_pull_m.assign(10, 2e-4);
  evidence.joint_pull_m[7] = 0.004;
  const auto result = judged_with(evidence);
  EXPECT_EQ(result.verdict, Verdict::uncertain) << described(result);
  ASSERT_TRUE(has_reason(result, "view_disagrees"));
  EXPECT_NE(result.reasons.front().text.find("view 7"), std::string::npos);
}

TEST(Verdict, HiddenLinkIsNamedButDoesNoHarm) {
  Evidence evidence = sound_evidence();
  evidence.links[1] = {1000, 950, 40, 10, 900};
  const auto result = judged_with(evidence);
  EXPECT_EQ(result.verdict, Verdict::accepted) << described(result);
  ASSERT_TRUE(has_reason(result, "link_not_seen"));
  EXPECT_NE(result.reasons.front().text.find("link_2"), std::string::npos);
}

TEST(Verdict, OtherShapeIsRejectedButStereosCorrelatedNoiseIsNot) {
  Refinement r = sound();
  r.range_correlation = 120;
  r.residual_rms_m = 0.009;
  EXPECT_EQ(judged_with(sound_evidence(), r).verdict, Verdict::accepted);
  Evidence evidence = sound_evidence();
  evidence.images.here = 0.45;
  expect_rejected(judged_with(evidence, r), "surface_differs");
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
