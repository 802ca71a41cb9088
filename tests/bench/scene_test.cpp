// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// The judge is judged: what the benchmark of random scenes holds against calibrate().
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/virtual_cell/virtual_cell.hpp"
#include "drivers/sim/render/depth_model.hpp"
#include "tests/bench/pose_bound.hpp"
#include "tests/bench/scene.hpp"

namespace calibrd::bench {
namespace {

Scene scene_of(std::uint64_t seed, sim::Level level, std::size_t postures) {
  static const SceneRobot robot = *read_scene_robot(CALIBRD_TEST_ARM6_URDF, {});
  static const auto tables = std::make_shared<const sim::SensorTables>(sim::CameraParameters{});
  sim::CaptureOptions options;
  options.level = level;
  options.postures = postures;
  auto scene = simulate_scene(robot, seed, options, tables);
  if (!scene) throw std::runtime_error(scene.error().message());
  return std::move(*scene);
}

bool is_beside_edge(const VirtualMeasurement& image, std::size_t i) {
  const auto width = static_cast<std::size_t>(image.width), x = i % width, y = i / width;
  if (x == 0 || y == 0 || x + 1 == width || y + 1 == static_cast<std::size_t>(image.height)) return true;
  return std::ranges::any_of(std::array{i - 1, i + 1, i - width, i + width}, [&](std::size_t n) {
    return image.link[n] < 0 || std::abs(image.depth_m[n] - image.depth_m[i]) >= 0.03F;
  });
}

/// What a plane under every pixel says, from the normals and in closed form: n·(t + d R r) is constant.
Matrix6d information_of_planes(const Scene& scene, std::size_t views) {
  const Pose& T = scene.truth.T_base_sensor;
  VirtualCell cell(scene.robot->model);
  VirtualMeasurement image;
  Matrix6d information = Matrix6d::Zero();
  for (std::size_t view = 0; view < views; ++view) {
    cell.set_joints(scene.true_joints_rad(view));
    cell.measure(scene.camera, T, image);
    for (std::size_t i = 0; i < image.depth_m.size(); ++i) {
      if (image.link[i] < 0 || is_beside_edge(image, i)) continue;
      const Eigen::Vector3d ray =
          scene.camera.ray(static_cast<double>(i % 512), static_cast<double>(i / 512));
      const Eigen::Vector3d r = T.linear() * ray, n = T.linear() * image.normal[i].cast<double>();
      const double depth = image.depth_m[i], along = n.dot(r);
      Vector6d row;
      row << -depth * r.cross(n) / along, -n / along;
      const double sigma = sim::axial_noise_m(depth, std::acos(std::min(1.0, -along / r.norm())));
      information += row * row.transpose() / (sigma * sigma + 1e-6 / 12);
    }
  }
  return information;
}

TEST(Scene, ReferenceIsTheTruthWhereJointsDoNotLie) {
  const Scene scene = scene_of(3, sim::Level::cell, 2);
  EXPECT_TRUE(pose_for_reported_joints(scene, 2).isApprox(scene.truth.T_base_sensor, 0));
  EXPECT_LT(check_point_rms_m(scene, scene.truth.T_base_sensor), 1e-6);
}

TEST(Scene, ReferenceFitsTheReportedJointsBetterThanTheTruthDoes) {
  const Scene scene = scene_of(3, sim::Level::field, 4);
  const Pose reference = pose_for_reported_joints(scene, 4);
  EXPECT_GT(difference(scene.truth.T_base_sensor, reference).norm(), 1e-4);
  EXPECT_LT(difference(scene.truth.T_base_sensor, reference).norm(), 2e-2);
  EXPECT_LT(check_point_rms_m(scene, reference), 0.9 * check_point_rms_m(scene, scene.truth.T_base_sensor));
}

TEST(Scene, ZerosComeInTheOrderOfTheModel) {
  const Scene scene = scene_of(3, sim::Level::field, 1);
  const auto& names = scene.robot->model.position_names();
  ASSERT_EQ(scene.joint_zeros_rad.size(), names.size());
  for (std::size_t j = 0; j < names.size(); ++j) {
    const auto at = std::ranges::find(scene.truth.joint_names, names[j]) - scene.truth.joint_names.begin();
    EXPECT_EQ(scene.joint_zeros_rad[j], scene.truth.joint_zero_rad[static_cast<std::size_t>(at)]);
  }
}

TEST(PoseBound, IsThatOfThePlanesUnderThePixels) {
  const Scene scene = scene_of(5, sim::Level::clean, 2);
  const PoseBounds bounds = pose_bounds(scene, 2);
  const Matrix6d covariance = information_of_planes(scene, 2).inverse();
  // The planes know nothing of facets' edges, which the bound leaves out where they are steps.
  EXPECT_NEAR(bounds.range_known.position_m / std::sqrt(covariance.bottomRightCorner<3, 3>().trace()), 1,
              0.03);
  EXPECT_NEAR(bounds.range_known.rotation_rad / std::sqrt(covariance.topLeftCorner<3, 3>().trace()), 1, 0.03);
}

TEST(PoseBound, FallsWithViewsAndRisesWithWhatIsUnknown) {
  const Scene scene = scene_of(5, sim::Level::clean, 3);
  const PoseBounds one = pose_bounds(scene, 1), three = pose_bounds(scene, 3);
  EXPECT_LT(three.range_known.position_m, one.range_known.position_m);
  EXPECT_LT(three.range_known.rotation_rad, one.range_known.rotation_rad);
  EXPECT_GT(one.range_free.position_m, one.range_known.position_m);
  EXPECT_GT(three.pixels, one.pixels);
}

}  // namespace
}  // namespace calibrd::bench
