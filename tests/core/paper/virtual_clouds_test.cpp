// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/paper/virtual_clouds.hpp"

#include <gtest/gtest.h>

#include "tests/core/registration/scene.hpp"

namespace calibrd {
namespace {

using namespace test;

View still(std::size_t posture) {
  View view;
  view.joint_positions_rad = postures(posture + 1).back();
  return view;
}

/// Whether a sensor at `T_base_sensor` sees each of the points (base frame).
std::vector<bool> seen_from(const Pose& T_base_sensor, const View& view, const Points& points_base) {
  VirtualCell cell(test_arm());
  cell.set_joints(view.joint_positions_rad);
  std::vector<bool> seen;
  for (const Eigen::Vector3f& p_sensor : moved(T_base_sensor.inverse(), points_base)) {
    const Eigen::Vector3d direction = p_sensor.cast<double>() / static_cast<double>(p_sensor.z());
    seen.push_back(std::abs(cell.hit_along(direction, T_base_sensor).depth_m - p_sensor.z()) < 2e-3F);
  }
  return seen;
}

double share(const std::vector<bool>& seen) {
  return static_cast<double>(std::ranges::count(seen, true)) / static_cast<double>(seen.size());
}

TEST(VirtualClouds, UniformSamplesLieOnHiddenSurfacesToo) {
  const View view = still(0);
  const double seen = share(seen_from(true_T_base_sensor(), view, sampled_uniformly(test_arm(), view, {})));
  EXPECT_GT(seen, 0.15);
  EXPECT_LT(seen, 0.6);
}

TEST(VirtualClouds, ThreeSensorsSeeMoreThanOneAndNothingThatIsInside) {
  const View view = still(0);
  const Pose first = true_T_base_sensor();
  const Points points = seen_by_three_sensors(test_arm(), ideal_kinect2(), view, first);
  ASSERT_GT(points.size(), 10000U);
  const Eigen::Vector3d middle = box_around(sampled_uniformly(test_arm(), view, {})).center();
  std::vector<bool> seen_by_any(points.size());
  for (const double turn_rad : {0.0, 2.0943951, 4.1887902}) {
    const Pose sensor = Eigen::Translation3d(middle) * Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()) *
                        Eigen::Translation3d(-middle) * first;
    const std::vector<bool> seen = seen_from(sensor, view, points);
    EXPECT_GT(share(seen), 0.2);
    EXPECT_LT(share(seen), 0.6);
    for (std::size_t i = 0; i < seen.size(); ++i) seen_by_any[i] = seen_by_any[i] || seen[i];
  }
  EXPECT_GT(share(seen_by_any), 0.99);
}

TEST(VirtualClouds, TheRobotsRegionLeavesOutWhatItStandsOn) {
  const Eigen::AlignedBox3d box = region_of_robot({{-0.2F, -0.3F, 0}, {0.4F, 0.5F, 1}}, 0.1);
  EXPECT_TRUE(box.min().isApprox(Eigen::Vector3d(-0.3, -0.4, 0.1), 1e-6));
  EXPECT_TRUE(box.max().isApprox(Eigen::Vector3d(0.5, 0.6, 1.1), 1e-6));
}

TEST(VirtualClouds, TheRegionHoldsWhatLiesInItsOwnFrame) {
  const View view = render_view(postures(1).front(), true_T_base_sensor(), {});
  const Region all{Pose::Identity(), {Eigen::Vector3d(-9, -9, 0), Eigen::Vector3d(9, 9, 9)}};
  const Region near_half{Pose::Identity(), {Eigen::Vector3d(-9, -9, 0), Eigen::Vector3d(9, 9, 1.5)}};
  const Region base_above{true_T_base_sensor(), {Eigen::Vector3d(-9, -9, 0.5), Eigen::Vector3d(9, 9, 9)}};
  const Points everything = measured_in(all, ideal_kinect2(), view);
  const auto near_ones = std::ranges::count_if(everything, [](const auto& p) { return p.z() <= 1.5F; });
  const Points base_points = moved(true_T_base_sensor(), everything);
  const auto high_ones = std::ranges::count_if(base_points, [](const auto& p) { return p.z() >= 0.5F; });
  EXPECT_GT(near_ones, 1000);
  EXPECT_GT(high_ones, 1000);
  EXPECT_NEAR(static_cast<double>(measured_in(near_half, ideal_kinect2(), view).size()),
              static_cast<double>(near_ones), 2);
  EXPECT_NEAR(static_cast<double>(measured_in(base_above, ideal_kinect2(), view).size()),
              static_cast<double>(high_ones), 2);
}

}  // namespace
}  // namespace calibrd
