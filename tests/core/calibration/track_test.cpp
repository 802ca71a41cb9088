// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/track.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "tests/core/registration/scene.hpp"
#include "tests/core/robot/scratch_folder.hpp"

namespace calibrd {
namespace {

using namespace test;

constexpr double kDegree = 0.0174532925199433;

PoseTracker tracker_of(const SceneSettings& scene, const TrackSettings& settings = {}) {
  return {VirtualCell(test_arm()), scene.camera, settings};
}

Pose slightly_off(std::uint64_t seed) { return off_by(true_T_base_sensor(), 0.002, 0.2 * kDegree, seed); }

void expect_error(const Result<TrackedPose>& tracked, TrackError error) {
  ASSERT_FALSE(tracked);
  EXPECT_EQ(tracked.error().code, make_error_code(error)) << tracked.error().message();
}

TEST(PoseTracker, PullsAPoseBackByOneFrame) {
  SceneSettings scene;
  scene.camera = kinect2();
  PoseTracker tracker = tracker_of(scene);
  for (const View& view : render_views(3, scene)) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const auto tracked = tracker.update(view, slightly_off(seed), {});
      ASSERT_TRUE(tracked) << tracked.error().message();
      const Vector6d error = difference(true_T_base_sensor(), tracked->T_base_sensor);
      EXPECT_LT(error.tail<3>().norm(), 1.5e-3);
      EXPECT_LT(error.head<3>().norm(), 1.5e-3);
      const Pose start = slightly_off(seed);
      EXPECT_LT((perturbed(start, tracked->innovation).matrix() - tracked->T_base_sensor.matrix()).norm(),
                1e-12);
      EXPECT_GT(tracked->innovation.tail<3>().norm(), 1e-3);
      EXPECT_GT(tracked->agreeing, tracked->measured / 2);
    }
  }
}

TEST(PoseTracker, InnovationsAreAsLargeAsTheirCovarianceSays) {
  SceneSettings scene;
  PoseTracker tracker = tracker_of(scene);
  double squares = 0;
  constexpr int kFrames = 40;
  for (int frame = 0; frame < kFrames; ++frame) {
    scene.seed = static_cast<std::uint64_t>(frame + 1);
    const View view =
        render_view(postures(4)[static_cast<std::size_t>(frame % 4)], true_T_base_sensor(), scene);
    const auto tracked = tracker.update(view, true_T_base_sensor(), {});
    ASSERT_TRUE(tracked) << tracked.error().message();
    squares += tracked->innovation.dot(tracked->covariance.ldlt().solve(tracked->innovation));
  }
  // χ² of 6 degrees of freedom over 40 frames: 6 ± 0.55.
  EXPECT_GT(squares / kFrames, 4);
  EXPECT_LT(squares / kFrames, 8.5);
}

TEST(PoseTracker, ASensorThatWasKnockedStandsOut) {
  PoseTracker tracker = tracker_of({});
  const Pose before = off_by(true_T_base_sensor(), 0.006, 0.4 * kDegree, 5);
  const auto tracked = tracker.update(render_views(1).front(), before, {});
  ASSERT_TRUE(tracked) << tracked.error().message();
  EXPECT_GT(tracked->innovation.dot(tracked->covariance.ldlt().solve(tracked->innovation)), 40);
}

TEST(PoseTracker, KnowsTheRangeOffsetOfTheLastCalibration) {
  SceneSettings scene;
  scene.offset_m = 0.012;
  PoseTracker tracker = tracker_of(scene);
  DepthCorrection correction;
  correction.offset_m = 0.012;
  const auto tracked = tracker.update(render_views(1, scene).front(), slightly_off(2), correction);
  ASSERT_TRUE(tracked) << tracked.error().message();
  EXPECT_LT(difference(true_T_base_sensor(), tracked->T_base_sensor).tail<3>().norm(), 1.5e-3);
  EXPECT_LT(std::abs(tracked->offset_change_m), 1e-3);
}

TEST(PoseTracker, SecondFrameDoesNotRememberTheFirst) {
  const auto views = render_views(2);
  PoseTracker used = tracker_of({}), fresh = tracker_of({});
  ASSERT_TRUE(used.update(views[0], slightly_off(1), {}));
  const auto one = used.update(views[1], slightly_off(1), {}),
             two = fresh.update(views[1], slightly_off(1), {});
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->T_base_sensor.matrix(), two->T_base_sensor.matrix());
}

TEST(PoseTracker, ClutterInFrontDoesNotPull) {
  SceneSettings scene;
  scene.clutter = true;
  scene.hidden_share = 0.45;
  PoseTracker tracker = tracker_of(scene);
  const auto tracked = tracker.update(render_views(1, scene).front(), slightly_off(3), {});
  if (!tracked) return expect_error(tracked, TrackError::too_few_pixels);
  const Vector6d error = difference(true_T_base_sensor(), tracked->T_base_sensor);
  EXPECT_LT(error.dot(tracked->covariance.ldlt().solve(error)), 35);
}

TEST(PoseTracker, AFrameThatDoesNotShowTheRobotSaysNothing) {
  View view = render_views(1).front();
  PoseTracker tracker = tracker_of({});
  std::ranges::fill(view.depth.raw, std::uint16_t{0});
  expect_error(tracker.update(view, true_T_base_sensor(), {}), TrackError::too_few_pixels);
  std::ranges::fill(view.depth.raw, std::uint16_t{600});
  expect_error(tracker.update(view, true_T_base_sensor(), {}), TrackError::too_few_pixels);
}

TEST(PoseTracker, WhatDoesNotFitIsRefused) {
  PoseTracker tracker = tracker_of({});
  View small = render_views(1).front();
  small.depth.raw.pop_back();
  expect_error(tracker.update(small, true_T_base_sensor(), {}), TrackError::wrong_image_size);
  View joints = render_views(1).front();
  joints.joint_positions_rad.pop_back();
  expect_error(tracker.update(joints, true_T_base_sensor(), {}), TrackError::wrong_joints);
  joints = render_views(1).front();
  joints.joint_positions_rad[2] = std::nan("");
  expect_error(tracker.update(joints, true_T_base_sensor(), {}), TrackError::wrong_joints);
}

TEST(PoseTracker, OneFlatFaceLeavesDirectionsOpen) {
  const ScratchFolder folder;
  const auto robot = RobotModel::load(
      folder.write("box.urdf",
                   "<robot name='box'><link name='base_link'><visual><geometry><box size='1 1 1'/>"
                   "</geometry></visual></link></robot>"),
      {{}, ""});
  ASSERT_TRUE(robot) << robot.error().message();
  Pose T_base_sensor = Pose::Identity();
  T_base_sensor.linear() = Eigen::AngleAxisd(3.14159265358979, Eigen::Vector3d::UnitX()).toRotationMatrix();
  T_base_sensor.translation().z() = 2;
  View view;
  const CameraModel camera = ideal_kinect2();
  view.depth = {camera.width, camera.height, 0.001, {}};
  view.depth.raw.assign(static_cast<std::size_t>(camera.width * camera.height), std::uint16_t{1500});
  PoseTracker tracker(VirtualCell(*robot), camera);
  expect_error(tracker.update(view, T_base_sensor, {}), TrackError::unobservable);
}

}  // namespace
}  // namespace calibrd
