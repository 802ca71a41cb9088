// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/timing/link_motion.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "tests/core/registration/scene.hpp"

namespace calibrd {
namespace {

using namespace test;

std::vector<double> moved(std::vector<double> joints, double seconds) {
  for (std::size_t j = 0; j < joints.size(); ++j) joints[j] += (0.3 - 0.1 * static_cast<double>(j)) * seconds;
  return joints;
}

TEST(LinkMotion, IsHowFastPointsOfLinksGo) {
  const auto joints = postures(1).front();
  const auto at = [&](double seconds) { return test_arm().forward_kinematics(moved(joints, seconds)); };
  const LinkMotion motion(at(-0.01), at(0), at(0.01), 0.02);
  const Eigen::Vector3d p_link(0.05, -0.02, 0.1);
  for (std::size_t link = 0; link < test_arm().links().size(); ++link) {
    const Eigen::Vector3d expected = (at(1e-4)[link] * p_link - at(-1e-4)[link] * p_link) / 2e-4;
    EXPECT_LT((motion.velocity(static_cast<int>(link), at(0)[link] * p_link) - expected).norm(), 1e-4);
  }
}

TEST(LinkReach, IsNeverShorterThanTheWayOfAnyVertex) {
  const auto from = postures(2).front(), to = moved(from, 0.5);
  const auto before = test_arm().forward_kinematics(from), after = test_arm().forward_kinematics(to);
  double most = 0;
  for (std::size_t link = 0; link < before.size(); ++link)
    for (const auto& vertex : test_arm().links()[link].surface.vertices)
      most =
          std::max(most, (after[link] * vertex.cast<double>() - before[link] * vertex.cast<double>()).norm());
  const double reach = LinkReach(test_arm()).farthest_m(from, to);
  EXPECT_GE(reach, most - 1e-9);
  EXPECT_LT(reach, 1.3 * most);
}

TEST(LinkReach, VelocityThatStaysDoesNotChange) {
  const auto a = postures(1).front();
  const LinkReach reach(test_arm());
  const auto b = moved(a, 0.025), c = moved(a, 0.05);
  EXPECT_LT(reach.velocity_change_m_s(a, b, c, 0.025, 0.025), 0.01);
  EXPECT_GT(reach.velocity_change_m_s(a, b, b, 0.025, 0.025), 0.05);
  EXPECT_LT(reach.velocity_change_m_s(a, moved(a, 0.02), moved(a, 0.05), 0.02, 0.03), 0.01);
}

}  // namespace
}  // namespace calibrd
