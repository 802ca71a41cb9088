// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/virtual_cell/surface_sampling.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "tests/core/virtual_cell/urdf_text.hpp"

namespace calibrd {
namespace {

using namespace test;

const Eigen::Vector3d kBaseSize(0.4, 0.3, 0.2), kArmSize(0.1, 0.6, 0.15);

/// Two boxes of different area; the second one at a joint.
RobotModel two_boxes() {
  return robot_from(link("base", box_shape(kBaseSize)) + link("arm", box_shape(kArmSize, shift(0, 0.3, 0))) +
                    revolute("joint", "base", "arm", "1 0 0", shift(0, 0, 0.5)));
}

/// Which of a box's six faces a point in the box's frame lies on; -1 when on none.
int face_of(const Eigen::Vector3d& p, const Eigen::Vector3d& size) {
  for (int axis = 0; axis < 3; ++axis) {
    if ((p.cwiseAbs() - size / 2).maxCoeff() > 1e-6) return -1;
    if (std::abs(std::abs(p[axis]) - size[axis] / 2) < 1e-6) return 2 * axis + (p[axis] > 0);
  }
  return -1;
}

double face_area(const Eigen::Vector3d& size, int face) { return size.prod() / size[face / 2]; }

Eigen::Vector3d in_box(const SurfaceSample& sample, const std::vector<Pose>& T_base_link, bool is_arm) {
  const Eigen::Vector3d p = T_base_link[static_cast<std::size_t>(sample.link)].inverse() * sample.point;
  return is_arm ? p - Eigen::Vector3d(0, 0.3, 0) : p;
}

TEST(SurfaceSampling, PointsLieOnTheSurfaceOfTheLinkTheyName) {
  const RobotModel robot = two_boxes();
  const std::vector joints{0.7};
  const auto T_base_link = robot.forward_kinematics(joints);
  const int arm = robot.find_link("arm").value();
  for (const SurfaceSample& sample : sample_surface(robot, joints, 2000, 1)) {
    const bool is_arm = sample.link == arm;
    const int face = face_of(in_box(sample, T_base_link, is_arm), is_arm ? kArmSize : kBaseSize);
    ASSERT_GE(face, 0) << sample.point.transpose();
    Eigen::Vector3d outward = Eigen::Vector3d::Zero();
    outward[face / 2] = face % 2 == 1 ? 1 : -1;
    EXPECT_LT((T_base_link[static_cast<std::size_t>(sample.link)].linear() * outward - sample.normal).norm(),
              1e-6);
  }
}

// Each face is cut into a 3x3 grid: 2 boxes * 6 faces * 9 cells, each expected to hold its share of the area.
TEST(SurfaceSampling, DensityIsTheSameEverywhere) {
  const RobotModel robot = two_boxes();
  const std::vector joints{0.7};
  const auto T_base_link = robot.forward_kinematics(joints);
  const int arm = robot.find_link("arm").value();
  constexpr std::size_t kCount = 40000;
  std::map<std::tuple<bool, int, int, int>, int> counts;
  for (const SurfaceSample& sample : sample_surface(robot, joints, kCount, 7)) {
    const bool is_arm = sample.link == arm;
    const Eigen::Vector3d& size = is_arm ? kArmSize : kBaseSize;
    const Eigen::Vector3d p = in_box(sample, T_base_link, is_arm);
    const int face = face_of(p, size);
    const int u = (face / 2 + 1) % 3, v = (face / 2 + 2) % 3;
    const auto cell = [&](int axis) {
      return std::clamp(static_cast<int>(3 * (p[axis] / size[axis] + 0.5)), 0, 2);
    };
    ++counts[{is_arm, face, cell(u), cell(v)}];
  }
  double total_area = 0;
  for (int face = 0; face < 6; ++face) total_area += face_area(kBaseSize, face) + face_area(kArmSize, face);
  double chi_square = 0;
  for (const bool is_arm : {false, true}) {
    for (int face = 0; face < 6; ++face) {
      const double expected = kCount * face_area(is_arm ? kArmSize : kBaseSize, face) / 9 / total_area;
      for (int u = 0; u < 3; ++u)
        for (int v = 0; v < 3; ++v)
          chi_square += std::pow(counts[{is_arm, face, u, v}] - expected, 2) / expected;
    }
  }
  EXPECT_EQ(counts.size(), 108U);
  EXPECT_LT(chi_square, 161);  // 107 degrees of freedom: exceeded once in 1900 seeds
}

TEST(SurfaceSampling, SameSeedGivesTheSamePoints) {
  const RobotModel robot = two_boxes();
  const auto a = sample_surface(robot, std::vector{0.1}, 500, 42),
             b = sample_surface(robot, std::vector{0.1}, 500, 42);
  const auto other = sample_surface(robot, std::vector{0.1}, 500, 43);
  ASSERT_EQ(a.size(), 500U);
  ASSERT_EQ(b.size(), 500U);
  int equal = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].point, b[i].point);
    EXPECT_EQ(a[i].link, b[i].link);
    equal += a[i].point == other[i].point;
  }
  EXPECT_EQ(equal, 0);
}

TEST(SurfaceSampling, PointsFollowTheJoints) {
  const RobotModel robot = two_boxes();
  const int arm = robot.find_link("arm").value();
  const std::vector still{0.0}, turned{std::numbers::pi / 2};
  const auto before = sample_surface(robot, still, 300, 5), after = sample_surface(robot, turned, 300, 5);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Eigen::Vector3d p = before[i].point;
    // A quarter turn about x through (0, 0, 0.5): y becomes z, z becomes -y.
    const Eigen::Vector3d expected =
        before[i].link == arm ? Eigen::Vector3d(p.x(), -(p.z() - 0.5), p.y() + 0.5) : p;
    EXPECT_LT((after[i].point - expected).norm(), 1e-9);
  }
}

TEST(SurfaceSampling, RobotWithoutSurfacesGivesNoPoints) {
  EXPECT_TRUE(sample_surface(robot_from(link("base")), {}, 100, 1).empty());
}

TEST(SurfaceSampling, NoPointsAskedForGivesNone) {
  EXPECT_TRUE(sample_surface(two_boxes(), std::vector{0.0}, 0, 1).empty());
}

}  // namespace
}  // namespace calibrd
