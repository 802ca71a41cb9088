// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/linearization.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/registration/lateral_noise.hpp"
#include "tests/core/registration/scene.hpp"

namespace calibrd {
namespace {

using namespace test;

struct Observed {
  std::vector<RegistrationView> views;
  std::vector<VirtualMeasurement> predictions;
  Linearization around;

  Observed(const Pose& T_base_sensor, int stride) {
    SceneSettings scene;
    scene.images = true;
    views = prepare_views(VirtualCell(test_arm()), scene.camera, render_views(2, scene), {});
    predictions.resize(views.size());
    LinearizationSettings settings;
    settings.range.kernel_m = 0.03;
    settings.range.kept_kernels = 1.5;
    settings.stride = stride;
    around.observe(views, predictions, scene.camera, T_base_sensor, {}, settings);
  }
};

class LinearizationAtStride : public testing::TestWithParam<int> {};

// Steps on one rendering must lead where a rendering from there would lead.
TEST_P(LinearizationAtStride, SumsAfterAStepAreThoseOfARenderingFromThere) {
  Vector6d step;
  step << 4e-4, -3e-4, 5e-4, 6e-4, -4e-4, 5e-4;
  ParameterVector delta = ParameterVector::Zero();
  delta.head<6>() = step;
  const Observed before(true_T_base_sensor(), GetParam()),
      after(perturbed(true_T_base_sensor(), step), GetParam());
  const ViewSums moved = before.around.sums(delta), rendered = after.around.sums(ParameterVector::Zero());
  const Vector6d pull = moved.range.gradient().head<6>(), expected = rendered.range.gradient().head<6>(),
                 unmoved = before.around.sums(ParameterVector::Zero()).range.gradient().head<6>();
  const Matrix6d information = rendered.range.information().topLeftCorner<6, 6>();
  const auto ldlt = information.ldlt();
  // As steps of the pose: what is left to go.
  EXPECT_LT(Vector6d(ldlt.solve(pull - expected)).norm(), 0.15 * step.norm());
  EXPECT_GT(Vector6d(ldlt.solve(unmoved - expected)).norm(), 0.7 * step.norm());
}

TEST_P(LinearizationAtStride, LooksAtEveryNthPixel) {
  const Observed all(true_T_base_sensor(), 1), some(true_T_base_sensor(), GetParam());
  const double share = 1.0 / (GetParam() * GetParam());
  EXPECT_NEAR(static_cast<double>(some.around.range_count()),
              share * static_cast<double>(all.around.range_count()),
              0.25 * share * static_cast<double>(all.around.range_count()));
}

INSTANTIATE_TEST_SUITE_P(, LinearizationAtStride, testing::Values(1, 2));

TEST(Linearization, ThinsItsSamplesEvenly) {
  const Observed observed(true_T_base_sensor(), 1);
  const auto thinned = observed.around.range_samples(500);
  EXPECT_GE(thinned.size(), 450U);
  EXPECT_LE(thinned.size(), 1100U);
  EXPECT_EQ(observed.around.range_samples(1000000).size(), observed.around.range_count());
}

/// Residuals of surfaces from head on to 70 degrees, with that much lateral noise.
std::vector<Sample> scattered(double lateral_px) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> angle(0, 1.2);
  std::vector<Sample> samples;
  for (int i = 0; i < 4000; ++i) {
    const double cosine = std::cos(angle(random));
    Sample& sample = samples.emplace_back();
    sample.depth_per_pixel_m = depth_per_pixel_m(1.3, cosine, 1 / 365.0);
    sample.observation.sigma = depth_sigma_m(1.3, cosine, 1 / 365.0, 0.4);
    sample.observation.residual = depth_sigma_m(1.3, cosine, 1 / 365.0, lateral_px) * normal(random);
  }
  return samples;
}

TEST(LateralNoise, IsFoundAsItWasPutIn) {
  for (const double lateral_px : {0.0, 0.3, 0.6}) {
    const auto found = find_lateral_noise(scattered(lateral_px), 0.4, 1);
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found, lateral_px, 0.15);
  }
}

TEST(LateralNoise, IsNotToldFromSurfacesSeenHeadOn) {
  std::vector<Sample> flat = scattered(0.3);
  std::erase_if(flat, [](const Sample& sample) { return sample.depth_per_pixel_m > 1e-3; });
  EXPECT_FALSE(find_lateral_noise(flat, 0.4, 1));
}

TEST(JointAxes, MotionAlongADirectionIsTheDerivativeSeenAlongIt) {
  const RobotModel& robot = test_arm();
  const auto joints = postures(1)[0];
  const JointAxes axes(robot, robot.forward_kinematics(joints));
  const Eigen::Vector3d p_base(0.4, -0.3, 0.8), direction = Eigen::Vector3d(0.3, -0.5, 0.8).normalized();
  for (int link = 0; link < static_cast<int>(robot.links().size()); ++link) {
    const JointZeros expected = axes.derivative(link, p_base).transpose() * direction;
    EXPECT_LT((axes.motion_along(link, p_base, direction) - expected).norm(), 1e-12) << link;
  }
}

}  // namespace
}  // namespace calibrd
