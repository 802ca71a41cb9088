// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/obstacles/find_obstacles.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/core/registration/scene.hpp"
#include "tests/core/virtual_cell/urdf_text.hpp"

namespace calibrd {
namespace {

using namespace test;

constexpr double kNoise_m = 0.0015;

/// The arm in its clutter as one sensor learnt it, and frames in which a box has come.
class Obstacles : public ::testing::Test {
 protected:
  Obstacles() {
    SceneSettings scene = scene_;
    std::vector<View> views;
    RobotMask mask(arm_, scene.camera);
    for (const auto& joints : postures(4)) {
      ++scene.seed;
      views.push_back(render_view(joints, T_base_sensor_, scene));
    }
    background_ = learn_background(mask, scene.camera, views, T_base_sensor_);
  }

  /// The arm in the posture of that number. `box_m`: of a box that stands with its middle at `middle_base`.
  View frame(std::size_t posture, const Eigen::Vector3d& box_m = Eigen::Vector3d::Zero(),
             const Eigen::Vector3d& middle_base = Eigen::Vector3d::Zero(), bool flying = false) {
    SceneSettings scene = scene_;
    scene.seed = 99;
    View view = render_view(postures(6)[posture], T_base_sensor_, scene);
    arm_.set_joints(view.joint_positions_rad);
    if (box_m.isZero()) return view;
    const RobotModel box = robot_from(link("box", box_shape(box_m, Pose(Eigen::Translation3d(middle_base)))));
    put_in_front(VirtualCell(box), view, flying);
    return view;
  }

  std::vector<Obstacle> find(const View& view) {
    return finder_.find(view, background_, T_base_sensor_, correction_);
  }

  /// Of what the sensor sees of the thing put there last, without noise.
  SurfacePoint true_nearest() const {
    SurfacePoint nearest{-1, {}, std::numeric_limits<double>::infinity()};
    for (int y = 0; y < thing_.height; ++y)
      for (int x = 0; x < thing_.width; ++x) {
        if (thing_.depth_m[thing_.index(x, y)] <= 0) continue;
        const Eigen::Vector3d p =
            T_base_sensor_ * (thing_.depth_m[thing_.index(x, y)] * scene_.camera.ray(x, y));
        if (const auto found = arm_.nearest_surface(p, nearest.distance_m)) nearest = *found;
      }
    return nearest;
  }

  SceneSettings scene_ = [] {
    SceneSettings scene;
    scene.clutter = true;
    return scene;
  }();
  const Pose T_base_sensor_ = true_T_base_sensor();
  VirtualCell arm_{test_arm()};
  BackgroundMap background_{scene_.camera};
  ObstacleFinder finder_{arm_, scene_.camera};
  DepthCorrection correction_;
  VirtualMeasurement thing_;

 private:
  void put_in_front(const VirtualCell& thing, View& view, bool flying) {
    thing.measure(scene_.camera, T_base_sensor_, thing_);
    std::mt19937 random(5);
    std::normal_distribution<double> normal(0, kNoise_m);
    std::uniform_real_distribution<double> uniform(0, 1);
    const DepthImage behind = view.depth;
    for (int y = 0; y < thing_.height; ++y)
      for (int x = 0; x < thing_.width; ++x) {
        const double z = correction_.measured(thing_.depth_m[thing_.index(x, y)]), old = behind.depth_m(x, y);
        if (thing_.depth_m[thing_.index(x, y)] <= 0 || (old > 0 && old < z)) continue;
        const bool at_edge =
            x > 0 && x + 1 < thing_.width && y > 0 && y + 1 < thing_.height &&
            (thing_.link[thing_.index(x - 1, y)] < 0 || thing_.link[thing_.index(x + 1, y)] < 0 ||
             thing_.link[thing_.index(x, y - 1)] < 0 || thing_.link[thing_.index(x, y + 1)] < 0);
        const double shown =
            flying && at_edge && old > 0 ? std::lerp(z, old, uniform(random)) : z + normal(random);
        view.depth.raw[thing_.index(x, y)] =
            static_cast<std::uint16_t>(std::lround(shown / view.depth.scale_m));
      }
  }
};

TEST_F(Obstacles, NoneIsFoundWhereNothingHasComeInPosturesLearntAndInOthers) {
  for (std::size_t posture = 0; posture < 6; ++posture) {
    const auto found = find(frame(posture));
    EXPECT_TRUE(found.empty()) << posture << ": " << found.size() << " with " << found.front().points
                               << " at " << found.front().centre_base.transpose();
  }
}

TEST_F(Obstacles, ABoxIsOneWithItsPlaceExtentAndDistanceFromTheArm) {
  const Eigen::Vector3d size(0.12, 0.2, 0.3), middle(0.75, -0.25, 0.15);
  const auto found = find(frame(0, size, middle));
  ASSERT_EQ(found.size(), 1U);
  const Obstacle& box = found.front();
  EXPECT_GT(box.points, 100U);
  EXPECT_GT(box.before_known_share, 0.7);  // behind the rest the arm stood, or an edge is
  // What is seen of it: its faces towards the sensor. A cell is 16 mm wide there.
  const Eigen::AlignedBox3d truth(middle - size / 2, middle + size / 2);
  EXPECT_LT((box.box_base.max() - truth.max()).cwiseAbs().maxCoeff(), 0.025);
  EXPECT_GT(box.box_base.min().x(), truth.min().x() - 0.02);
  EXPECT_TRUE(truth.contains(box.centre_base));
  const SurfacePoint nearest = true_nearest();
  EXPECT_NEAR(box.distance_m, nearest.distance_m, 0.005);
  EXPECT_EQ(box.link, nearest.link);
  EXPECT_NEAR((box.nearest_base - box.nearest_robot_base).norm(), box.distance_m, 1e-6);
}

TEST_F(Obstacles, FlyingPixelsAroundABoxMakeNoneAndDoNotBringItNearer) {
  const auto found = find(frame(1, {0.12, 0.2, 0.3}, {0.75, -0.25, 0.15}, true));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found.front().distance_m, true_nearest().distance_m, 0.012);
}

TEST_F(Obstacles, DistanceIsThatOfTheTrueDepthWhereTheSensorsRangeIsOff) {
  correction_ = {1.003, 0.012, 0, 0, 0};
  scene_.scale = correction_.scale;
  scene_.offset_m = correction_.offset_m;
  std::vector<View> views{frame(0), frame(1), frame(2), frame(3)};
  RobotMask mask(arm_, scene_.camera);
  background_ = learn_background(mask, scene_.camera, views, T_base_sensor_);
  const auto found = find(frame(0, {0.12, 0.2, 0.3}, {0.75, -0.25, 0.15}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found.front().distance_m, true_nearest().distance_m, 0.005);
}

TEST_F(Obstacles, TwoBoxesAreTwoNearestFirst) {
  View view = frame(0, {0.1, 0.1, 0.25}, {0.8, -0.45, 0.125});
  const SurfacePoint far = true_nearest();
  const View other = frame(0, {0.1, 0.1, 0.25}, {0.55, 0.0, 0.125});
  const SurfacePoint near = true_nearest();
  for (std::size_t i = 0; i < view.depth.raw.size(); ++i)
    if (thing_.link[i] >= 0) view.depth.raw[i] = std::min(view.depth.raw[i], other.depth.raw[i]);
  const auto found = find(view);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].distance_m, std::min(far.distance_m, near.distance_m), 0.005);
  EXPECT_NEAR(found[1].distance_m, std::max(far.distance_m, near.distance_m), 0.005);
}

TEST_F(Obstacles, WhatTheArmMayCarryIsToldFromWhatIsElsewhere) {
  arm_.set_joints(postures(1).front());
  const Eigen::Vector3d tip = arm_.link_poses().back().translation();
  const Eigen::Vector3d towards = (T_base_sensor_.translation() - tip).normalized();
  auto found = find(frame(0, {0.1, 0.1, 0.1}, tip + 0.2 * towards));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found.front().near_tool);
  found = find(frame(0, {0.12, 0.2, 0.3}, {0.75, -0.25, 0.15}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_FALSE(found.front().near_tool);
}

TEST_F(Obstacles, OfABackgroundNeverSeenEveryThingIsOneThatSaysSo) {
  background_ = BackgroundMap(scene_.camera);
  const auto found = find(frame(0));
  ASSERT_FALSE(found.empty());
  for (const Obstacle& obstacle : found) EXPECT_EQ(obstacle.before_known_share, 0);
}

}  // namespace
}  // namespace calibrd
