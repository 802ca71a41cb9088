// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Simulator and core know nothing of each other. Here, and only here, one is held against the other.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "core/capture/capture.hpp"
#include "core/geometry/camera_model.hpp"
#include "core/robot/robot_model.hpp"
#include "core/virtual_cell/virtual_cell.hpp"
#include "drivers/sim/model/postures.hpp"
#include "drivers/sim/scenes/capture_folder.hpp"
#include "tests/core/robot/scratch_folder.hpp"
#include "tests/core/robot/shared_data.hpp"
#include "tests/drivers/sim/sim_fixtures.hpp"

namespace calibrd::sim {
namespace {

CameraModel core_camera(const CameraParameters& p) {
  return {p.width, p.height, p.fx, p.fy, p.cx, p.cy, p.distortion};
}

CameraParameters kinect(bool distorted) {
  CameraParameters parameters;
  if (distorted) parameters.distortion = {0.0905, -0.268, 0.0007, -0.0004, 0.0951};
  return parameters;
}

/// The same robot, read by both.
struct Pair {
  Robot simulated;
  RobotModel core;
};

Pair read_both(const std::filesystem::path& urdf, const std::filesystem::path& models) {
  auto simulated = read_robot(urdf, {{models}, ""});
  auto core = RobotModel::load(urdf, {{models}, ""});
  if (!simulated || !core) throw std::runtime_error("cannot read " + urdf.string());
  return {std::move(*simulated), std::move(*core)};
}

void expect_same_kinematics(const Pair& pair) {
  ASSERT_EQ(pair.simulated.positions.size(), pair.core.position_count());
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Joints q = random_posture(pair.simulated, random);
    const auto poses = pair.simulated.link_poses(q);
    const auto core_poses = pair.core.forward_kinematics(std::span(q).first(pair.core.position_count()));
    for (std::size_t l = 0; l < poses.size(); ++l) {
      const auto core_link = pair.core.find_link(pair.simulated.links[l].name);
      ASSERT_TRUE(core_link);
      const auto& core_pose = core_poses[static_cast<std::size_t>(*core_link)];
      ASSERT_LT((poses[l].matrix() - core_pose.matrix()).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

/// Looks at both pictures of the robot alone from several places.
void expect_same_pictures(const Pair& pair, bool distorted) {
  World world;
  world.cell.robot = pair.simulated;
  world.state.joint_count = static_cast<std::int32_t>(pair.simulated.positions.size());
  world.state.sensor_count = 1;
  const CameraParameters parameters = kinect(distorted);
  SensorModel model(world.cell, parameters);
  VirtualCell cell(pair.core);
  VirtualMeasurement measured;
  Random random(2);
  for (int i = 0; i < 8; ++i) {
    const Joints q = random_posture(pair.simulated, random);
    world.state.motion.place(q, 0);
    cell.set_joints(std::span(q).first(pair.core.position_count()));
    Pose T_base_sensor =
        Eigen::Translation3d(0, 0, 0.5) * Eigen::AngleAxisd(random.uniform(-3, 3), Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(-2.0, Eigen::Vector3d::UnitX()) * Eigen::Translation3d(0.05, 0.1, -1.2);
    world.state.sensors[0].T_base_sensor = PoseValues::of(T_base_sensor);
    test::expose(model, world.state);
    cell.measure(core_camera(parameters), T_base_sensor, measured);
    int both = 0, one = 0, off = 0;
    double sum = 0;
    for (std::size_t p = 0; p < measured.depth_m.size(); ++p) {
      const double ours = model.truth().depth_m[p], cores = measured.depth_m[p];
      one += (ours > 0) != (cores > 0);
      if (ours == 0 || cores == 0) continue;
      ++both;
      off += std::abs(ours - cores) > 1e-4;
      sum += std::abs(ours - cores) < 1e-4 ? ours - cores : 0;
    }
    EXPECT_GT(both, 2000);
    EXPECT_LE(one, 4) << "of " << both;  // a ray that grazes an outline may go either way
    EXPECT_LE(off, 6) << "of " << both;  // likewise where one link covers another
    EXPECT_LT(std::abs(sum / both), 2e-6);
  }
}

TEST(AgainstCore, CamerasAgree) {
  const CameraParameters parameters = kinect(true);
  const Camera camera(parameters);
  const CameraModel core = core_camera(parameters);
  for (int v = 0; v < 424; v += 11)
    for (int u = 0; u < 512; u += 11) {
      const Eigen::Vector2d ray = camera.undistorted(u, v);
      ASSERT_LT((ray - core.ray(u, v).head<2>()).norm(), 1e-9);
      ASSERT_LT((camera.pixel(ray) - core.project({ray.x(), ray.y(), 1})).norm(), 1e-9);
    }
}

TEST(AgainstCore, KinematicsOfTheDemoRobotAgree) { expect_same_kinematics(read_both(test::demo_urdf(), "")); }

TEST(AgainstCore, PicturesOfTheDemoRobotAgree) {
  const Pair pair = read_both(test::demo_urdf(), "");
  expect_same_pictures(pair, false);
  expect_same_pictures(pair, true);
}

TEST(AgainstCore, KinematicsAndPicturesOfACollada7AxisArmAgree) {
  const auto models = calibrd::test::shared_data() / "models";
  SKIP_WITHOUT(models);
  const Pair pair = read_both(models / "motoman_sia5d_support/urdf/sia5d.urdf", models);
  expect_same_kinematics(pair);
  expect_same_pictures(pair, false);
}

TEST(AgainstCore, RecordingIsReadAsItWasSimulated) {
  const calibrd::test::ScratchFolder folder;
  const auto robot = read_robot(test::demo_urdf(), {});
  const auto tables = std::make_shared<const SensorTables>(kinect(true));
  CaptureOptions options;
  options.postures = 2;
  const auto simulated = simulate_capture(*robot, 4, options, tables);
  ASSERT_TRUE(simulated);
  const auto place = folder.path() / "capture";
  ASSERT_TRUE(write_capture_folder(place, *simulated, test::demo_urdf().string()));
  const auto read = read_capture(place, {});
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->joint_names, simulated->joint_names);
  EXPECT_EQ(read->camera.distortion, simulated->camera.distortion);
  ASSERT_EQ(read->views.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read->views[i].depth.raw, simulated->views[i].depth_mm);
    EXPECT_EQ(read->views[i].image->pixels, simulated->views[i].infrared);
    for (std::size_t j = 0; j < 7; ++j)
      EXPECT_NEAR(read->views[i].joint_positions_rad[j], simulated->views[i].joint_positions_rad[j], 1e-14);
  }
}

}  // namespace
}  // namespace calibrd::sim
