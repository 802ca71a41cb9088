// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drivers/sim/render/camera.hpp"
#include "tests/drivers/sim/panel_scene.hpp"

namespace calibrd::sim {
namespace {

constexpr std::array<double, 5> kLens{0.0905, -0.268, 0.001, -0.0005, 0.0951};

TEST(Camera, UndistortsWhatItDistorts) {
  CameraParameters parameters;
  parameters.distortion = kLens;
  const Camera camera(parameters);
  for (int v = 0; v < parameters.height; v += 13)
    for (int u = 0; u < parameters.width; u += 17)
      EXPECT_LT((camera.pixel(camera.undistorted(u, v)) - Eigen::Vector2d(u, v)).norm(), 1e-8);
}

TEST(Camera, DistortsAsTheFormulaSays) {
  CameraParameters parameters;
  parameters.distortion = {0.1, 0, 0, 0, 0};
  // r^2 = 0.25, factor 1.025
  EXPECT_NEAR(Camera(parameters).pixel({0.3, 0.4}).x(), parameters.cx + parameters.fx * 0.3 * 1.025, 1e-9);
  EXPECT_NEAR(Camera(parameters).pixel({0.3, 0.4}).y(), parameters.cy + parameters.fy * 0.4 * 1.025, 1e-9);
}

TEST(SampleGrid, NineSamplesDifferInBothAxesAndTheMiddleOneIsThePixel) {
  std::vector<double> xs, ys;
  for (int sy = 30; sy < 33; ++sy)
    for (int sx = 60; sx < 63; ++sx) {
      xs.push_back(SampleGrid::position(sx, sy).x() - 20);
      ys.push_back(SampleGrid::position(sx, sy).y() - 10);
    }
  EXPECT_EQ(xs[4], 0);
  EXPECT_EQ(ys[4], 0);
  std::sort(xs.begin(), xs.end());
  std::sort(ys.begin(), ys.end());
  for (int i = 0; i < 9; ++i) {
    EXPECT_NEAR(xs[static_cast<std::size_t>(i)], (i - 4) / 9.0, 1e-12);
    EXPECT_NEAR(ys[static_cast<std::size_t>(i)], (i - 4) / 9.0, 1e-12);
  }
}

/// Depth of every pixel of a slanted wall, against the plane's equation.
void expect_wall_exact(test::PanelScene scene, double distance, double turn) {
  SensorModel model(scene.cell, scene.sensor().camera);
  test::expose(model, scene.state);
  const CameraParameters& p = scene.sensor().camera;
  const Camera camera(p);
  const Eigen::Vector3d normal(-std::sin(turn), 0, -std::cos(turn));
  for (int y = 0; y < p.height; y += 3)
    for (int x = 0; x < p.width; x += 3) {
      const Eigen::Vector2d ray = camera.undistorted(x, y);
      const double z = normal.z() * distance / normal.dot(Eigen::Vector3d(ray.x(), ray.y(), 1));
      ASSERT_NEAR(model.truth().depth_m[scene.at(x, y)], z, 2e-6 * z) << x << " " << y;
      const double cosine = -normal.dot(Eigen::Vector3d(ray.x(), ray.y(), 1).normalized());
      ASSERT_NEAR(model.truth().cosine[scene.at(x, y)], cosine, 1e-5);
    }
}

TEST(Renderer, WallIsWhereThePlaneIs) {
  expect_wall_exact(test::wall(2.0), 2.0, 0);
  expect_wall_exact(test::wall(1.5, 0.6), 1.5, 0.6);
}

TEST(Renderer, LensDistortionIsInEveryRay) {
  test::PanelScene scene = test::wall(1.5, -0.5);
  scene.sensor().camera.distortion = kLens;
  expect_wall_exact(scene, 1.5, -0.5);
}

TEST(Renderer, WhatIsBehindOrBesideTheSensorIsNotSeen) {
  test::PanelScene scene;
  scene.add_panel({0, 0, -1}, {1, 1});
  scene.add_panel({5, 0, 1}, {1, 1});
  SensorModel model(scene.cell, scene.sensor().camera);
  test::expose(model, scene.state);
  for (const float depth : model.truth().depth_m) ASSERT_EQ(depth, 0);
}

TEST(Renderer, FloorThatPassesUnderTheSensorIsCutAtNoPlane) {
  test::PanelScene scene;
  const double half_turn = std::numbers::pi / 2;
  scene.add_panel({0, 0, 0}, {100, 100});
  Eigen::Isometry3d floor = Eigen::Isometry3d::Identity();
  floor.linear() = Eigen::AngleAxisd(-half_turn, Eigen::Vector3d::UnitX()).toRotationMatrix();
  floor.translation() = Eigen::Vector3d(0, 1, 0);  // y points down: one metre under the sensor
  scene.state.objects[0].T_base_object = PoseValues::of(floor);
  SensorModel model(scene.cell, scene.sensor().camera);
  test::expose(model, scene.state);
  const CameraParameters& p = scene.sensor().camera;
  for (int y = 0; y < p.height; ++y) {
    const double slope = (y - p.cy) / p.fy, z = slope > 0 ? 1 / slope : 0;
    const double expected = z > 0 && z < 50 ? z : 0;
    ASSERT_NEAR(model.truth().depth_m[scene.at(256, y)], expected, 1e-4 * z) << y;
  }
}

TEST(Renderer, SmallTrianglesLeaveNoGaps) {
  test::PanelScene scene;
  scene.cell.objects.push_back({"ball", make_capsule(0.5, 0, 200), {}});
  scene.state.objects[0].T_base_object.rows[11] = 1.5;
  scene.state.object_count = 1;
  scene.sensor().camera.distortion = kLens;
  SensorModel model(scene.cell, scene.sensor().camera);
  test::expose(model, scene.state);
  const Camera camera(scene.sensor().camera);
  int inside = 0;
  for (int y = 0; y < 424; ++y)
    for (int x = 0; x < 512; ++x) {
      const Eigen::Vector2d n = camera.undistorted(x, y);
      const Eigen::Vector3d ray = Eigen::Vector3d(n.x(), n.y(), 1).normalized();
      if (Eigen::Vector3d(0, 0, 1.5).cross(ray).norm() > 0.45) continue;
      ++inside;
      ASSERT_GT(model.truth().depth_m[scene.at(x, y)], 0.9) << x << " " << y;
    }
  EXPECT_GT(inside, 30000);
}

/// Where the upright edge of a bright panel appears in the infrared image, px: from how much of the row is
/// lit.
double edge_seen(double edge_px, double blur_px) {
  test::PanelScene scene;
  const CameraParameters& p = scene.sensor().camera;
  const double x = (edge_px - p.cx) / p.fx;  // at 1 m
  scene.add_panel({x - 1, 0, 1}, {2, 2});    // its side is turned away
  scene.sensor().infrared.blur_px = blur_px;
  static const auto tables = std::make_shared<const SensorTables>(p);
  SensorModel model(scene.cell, tables);
  const auto image = test::expose(model, scene.state).infrared;
  double seen = 0;
  for (int row = 195; row < 215; ++row) {
    const double lit = image[scene.at(static_cast<int>(edge_px) - 4, row)];
    double sum = 0;
    for (int i = -4; i <= 4; ++i) sum += image[scene.at(static_cast<int>(edge_px) + i, row)] / lit;
    seen += static_cast<int>(edge_px) - 4.5 + sum;
  }
  return seen / 20;
}

TEST(Renderer, EdgesLieWhereTheyAreToAFractionOfAPixel) {
  for (const double blur : {0.0, 0.4}) {
    double sum = 0;
    constexpr int kSteps = 20;
    for (int i = 0; i < kSteps; ++i) {
      const double edge = 256 + (i + 0.3) / kSteps;  // near the axis, where the light is even
      const double error = edge_seen(edge, blur) - edge;
      EXPECT_LT(std::abs(error), 0.07) << edge;  // nine samples: levels of 1/9 px
      sum += error;
    }
    EXPECT_LT(std::abs(sum / kSteps), 0.01) << blur;
  }
}

TEST(Renderer, RedrawingOnlyWhatMovesChangesNothing) {
  World world = test::world_from(
      std::string(R"(, "objects": [{"name": "b", "box_m": [2, 2, 0.1], "position_m": [0, 0, -0.05]}],
                      "person": {"present": true, "from_m": [-1, -1], "to_m": [-1, 1]})") +
      test::kPlainSensor);
  world.state.sensors[0].infrared.blur_px = 0.4;
  SensorModel model(world.cell, world.state.sensors[0].camera);
  for (int i = 0; i < 6; ++i) {
    world.state.motion.place({0.3 * i, 0.2 * i, 0.1, -0.2 * i, 0.3, 0.1 * i, 0}, 0);
    if (i == 4) world.state.objects[0].T_base_object.rows[3] = 0.3;
    if (i == 5) world.state.person.present = 0;
    const std::int64_t now_ns = 1'000'000'000LL * i;
    const auto kept = test::expose(model, world.state, 1, now_ns);
    SensorModel fresh(world.cell, world.state.sensors[0].camera);
    const auto anew = test::expose(fresh, world.state, 1, now_ns);
    EXPECT_EQ(kept.depth_mm, anew.depth_mm) << i;
    EXPECT_EQ(kept.infrared, anew.infrared) << i;
    EXPECT_EQ(model.truth().mixed_m, fresh.truth().mixed_m) << i;
    EXPECT_GT(model.robot_pixels(), 2000U);
  }
}

}  // namespace
}  // namespace calibrd::sim
