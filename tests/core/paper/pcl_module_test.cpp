// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/paper/pcl_module.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/paper/paper_error.hpp"

namespace calibrd {
namespace {

/// Points of a shape without symmetry: three faces of a box of unequal sides.
Points corner(std::size_t count) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3f p(0.9F * uniform(random), 0.6F * uniform(random), 0.4F * uniform(random));
    p[static_cast<Eigen::Index>(i % 3)] = 0;
    points.push_back(p);
  }
  return points;
}

Pose small_step() {
  Pose step = Pose::Identity();
  step.linear() = exp_so3({0.02, -0.015, 0.01});
  step.translation() << 0.012, -0.008, 0.01;
  return step;
}

TEST(PclModule, MapsTheMeasuredOntoTheModel) {  // and not the other way round, as equations 4 and 6 mix it
  PaperSettings settings;
  settings.voxel_m = 1e-4;  // keeps each point, so that the two clouds are the same but for the step
  const Points model = corner(6000);
  const auto aligned = align_by_pcl(moved(small_step().inverse(), model), model, settings);
  ASSERT_TRUE(aligned) << aligned.error().message();
  EXPECT_TRUE(aligned->converged);
  const Vector6d error = difference(small_step(), aligned->T_virtual_real);
  EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT(aligned->rms_m, 1e-5);
}

TEST(PclModule, ThinsBothCloudsToOnePointPerVoxel) {
  PaperSettings settings;
  settings.voxel_m = 0.1;
  const auto aligned = align_by_pcl(corner(20000), corner(20000), settings);
  ASSERT_TRUE(aligned) << aligned.error().message();
  EXPECT_EQ(aligned->measured_points, aligned->model_points);
  EXPECT_NEAR(static_cast<double>(aligned->model_points), 9 * 6 + 9 * 4 + 6 * 4, 20);  // edges share voxels
}

TEST(PclModule, SaysWhenTheIterationsWereUsedUp) {
  PaperSettings settings;
  settings.max_iterations = 1;
  const auto aligned = align_by_pcl(moved(small_step(), corner(6000)), corner(6000), settings);
  ASSERT_TRUE(aligned) << aligned.error().message();
  EXPECT_FALSE(aligned->converged);
}

TEST(PclModule, FailsOnCloudsThatLieApart) {
  Pose far_away = Pose::Identity();
  far_away.translation().x() = 5;
  const auto aligned = align_by_pcl(moved(far_away, corner(1000)), corner(1000), {});
  ASSERT_FALSE(aligned);
  EXPECT_EQ(aligned.error().code, PaperError::pcl_failed);
  EXPECT_EQ(align_by_pcl({}, corner(10), {}).error().code, PaperError::pcl_failed);
}

}  // namespace
}  // namespace calibrd
