// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/virtual_cell/virtual_cell.hpp"

#include <gtest/gtest.h>

#include "tests/core/virtual_cell/analytic_shapes.hpp"
#include "tests/core/virtual_cell/picture.hpp"

namespace calibrd {
namespace {

using namespace test;

// ---- against shapes whose picture can be computed by hand

TEST(VirtualCell, BoxMatchesItsAnalyticPictureInEveryPixel) {
  const Eigen::Vector3d size(0.4, 0.3, 0.5);
  Pose T_base_box = shift(0.1, 0.05, 0.3);
  T_base_box.linear() = exp_so3({0.3, -0.2, 0.5});
  const RobotModel robot = robot_from(link("base", box_shape(size, T_base_box)));
  const CameraModel camera = small_camera();
  const Pose T_base_sensor = skew_pose();
  const VirtualMeasurement m = measured(VirtualCell(robot), camera, T_base_sensor);

  const Pose T_box_sensor = T_base_box.inverse() * T_base_sensor;
  const Eigen::Vector3d rim = Eigen::Vector3d::Constant(2e-6);
  int hits = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d start = T_box_sensor.translation();
      const Eigen::Vector3d direction = T_box_sensor.linear() * camera.ray(x, y);
      const auto inner = meet_box(start, direction, size - rim),
                 outer = meet_box(start, direction, size + rim);
      const std::size_t i = pixel(m, x, y);
      if (!outer) {
        EXPECT_EQ(m.link[i], -1) << x << ' ' << y;
        EXPECT_EQ(m.depth_m[i], 0.0F);
        EXPECT_TRUE(m.normal[i].isZero());
      } else if (inner && inner->normal == outer->normal) {
        ++hits;
        const auto exact = meet_box(start, direction, size);
        ASSERT_EQ(m.link[i], 0) << x << ' ' << y;
        EXPECT_NEAR(m.depth_m[i], exact->depth, 3e-6);
        const Eigen::Vector3d normal_sensor = T_box_sensor.linear().transpose() * exact->normal;
        EXPECT_LT((m.normal[i].cast<double>() - normal_sensor).norm(), 1e-5);
      }
    }
  }
  EXPECT_GT(hits, 2000);
}

TEST(VirtualCell, SphereMatchesItsAnalyticPictureWithinItsTessellation) {
  const double radius = 0.25;
  const RobotModel robot = robot_from(link("base", sphere_shape(radius)));
  const CameraModel camera = small_camera();
  const Pose T_base_sensor = looking_at({0.8, 0.6, 0.4}, {0.02, 0.03, -0.01});
  const VirtualMeasurement m = measured(VirtualCell(robot), camera, T_base_sensor);
  int hits = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto exact =
          meet_sphere(T_base_sensor.translation(), T_base_sensor.linear() * camera.ray(x, y), radius);
      if (!exact) continue;
      const Eigen::Vector3d normal_sensor = T_base_sensor.linear().transpose() * exact->normal;
      const double cosine = -normal_sensor.dot(camera.ray(x, y).normalized());
      if (cosine < 0.3) continue;  // at the rim the facets decide
      ++hits;
      EXPECT_NEAR(m.depth_m[pixel(m, x, y)], exact->depth, 1e-4 / cosine + 2e-6) << x << ' ' << y;
      EXPECT_GT(m.normal[pixel(m, x, y)].cast<double>().dot(normal_sensor), std::cos(0.12));
    }
  }
  EXPECT_GT(hits, 2000);
}

// The sensor hangs at (2, 0, 0.5) and looks along -x of the base. Its picture's right is then +y of the base
// and its picture's down is -z: worked out by hand, with no transform of the library involved.
TEST(VirtualCell, PoseMapsSensorAxesToBaseAxes) {
  const RobotModel robot = robot_from(link("base", box_shape({0.2, 0.1, 0.1}, shift(0, 0.3, 0.5))) +
                                      link("above", box_shape({0.2, 0.1, 0.1}, shift(0, 0, 0.8))) +
                                      revolute("joint", "base", "above", "0 0 1", Pose::Identity()));
  Pose T_base_sensor = Pose::Identity();
  T_base_sensor.linear().col(0) = Eigen::Vector3d(0, 1, 0);
  T_base_sensor.linear().col(1) = Eigen::Vector3d(0, 0, -1);
  T_base_sensor.linear().col(2) = Eigen::Vector3d(-1, 0, 0);
  T_base_sensor.translation() = Eigen::Vector3d(2, 0, 0.5);
  const CameraModel camera{201, 201, 190, 190, 100, 100, {0, 0, 0, 0, 0}};
  const VirtualMeasurement m = measured(VirtualCell(robot), camera, T_base_sensor);
  const int base = robot.find_link("base").value(), above = robot.find_link("above").value();
  // Both front faces lie 1.9 m ahead: 0.3 m are 30 pixels.
  EXPECT_EQ(m.link[pixel(m, 130, 100)], base);
  EXPECT_EQ(m.link[pixel(m, 100, 70)], above);
  EXPECT_NEAR(m.depth_m[pixel(m, 130, 100)], 1.9F, 1e-6F);
  EXPECT_LT((m.normal[pixel(m, 130, 100)] - Eigen::Vector3f(0, 0, -1)).norm(), 1e-6F);
  for (const auto& [x, y] : {std::pair{70, 100}, {100, 130}, {100, 100}})
    EXPECT_EQ(m.link[pixel(m, x, y)], -1) << x << ' ' << y;
}

TEST(VirtualCell, NearerLinkHidesTheFarther) {
  const RobotModel robot = robot_from(link("base", box_shape({1, 1, 0.1})) +
                                      link("arm", box_shape({0.2, 0.2, 0.1}, shift(0, 0, 0.4))) +
                                      revolute("joint", "base", "arm", "0 0 1", Pose::Identity()));
  Pose from_above = shift(0, 0, 2);
  from_above.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  const CameraModel camera{101, 101, 80, 80, 50, 50, {0, 0, 0, 0, 0}};
  const VirtualMeasurement m = measured(VirtualCell(robot), camera, from_above);
  EXPECT_EQ(m.link[pixel(m, 50, 50)], robot.find_link("arm").value());
  EXPECT_NEAR(m.depth_m[pixel(m, 50, 50)], 2 - 0.45F, 1e-6F);
  EXPECT_EQ(m.link[pixel(m, 65, 50)], robot.find_link("base").value());
  EXPECT_NEAR(m.depth_m[pixel(m, 65, 50)], 2 - 0.05F, 1e-6F);
}

// ---- pixel grid and lens

TEST(VirtualCell, PixelCentresAreWholeNumbers) {
  // The box's right edge projects to 100.4, then to 100.6: pixel 100 sees it both times, pixel 101 never.
  for (const double edge_px : {100.4, 100.6}) {
    const CameraModel camera{161, 121, 150, 150, 80, 60, {0, 0, 0, 0, 0}};
    const double right = (edge_px - camera.cx) / camera.fx;  // at the front face, 1 m ahead
    const RobotModel robot =
        robot_from(link("base", box_shape({0.2, 0.2, 0.1}, shift(right - 0.1, 0, 1.05))));
    const VirtualMeasurement m = measured(VirtualCell(robot), camera, Pose::Identity());
    EXPECT_EQ(last_column(m, 60), 100) << edge_px;
  }
}

TEST(VirtualCell, RowsCountDownwardsFromTheTop) {
  const CameraModel camera{161, 121, 150, 150, 80, 60, {0, 0, 0, 0, 0}};
  const double bottom = (70.4 - camera.cy) / camera.fy;
  const RobotModel robot = robot_from(link("base", box_shape({0.2, 0.2, 0.1}, shift(0, bottom - 0.1, 1.05))));
  const VirtualMeasurement m = measured(VirtualCell(robot), camera, Pose::Identity());
  EXPECT_EQ(m.link[pixel(m, 80, 70)], 0);
  EXPECT_EQ(m.link[pixel(m, 80, 71)], -1);
}

TEST(VirtualCell, DistortedPixelSeesAlongItsRay) {
  const CameraModel camera{161, 121, 110, 112, 78.2, 61.3, {0.09, -0.27, 0.002, -0.001, 0.09}};
  const Eigen::Vector3d size(2.0, 1.6, 0.2);
  Pose T_base_box = shift(0, 0, 1.5);
  T_base_box.linear() = exp_so3({0.3, 0.4, 0.1});
  const RobotModel robot = robot_from(link("base", box_shape(size, T_base_box)));
  const VirtualMeasurement m = measured(VirtualCell(robot), camera, Pose::Identity());
  const Pose T_box_base = T_base_box.inverse();
  int hits = 0;
  for (int y = 0; y < camera.height; y += 3) {
    for (int x = 0; x < camera.width; x += 3) {
      const auto exact = meet_box(T_box_base.translation(), T_box_base.linear() * camera.ray(x, y), size);
      if (!exact || std::abs(exact->normal.z()) < 0.5) continue;
      ++hits;
      EXPECT_NEAR(m.depth_m[pixel(m, x, y)], exact->depth, 5e-6) << x << ' ' << y;
    }
  }
  EXPECT_GT(hits, 1000);
}

// The other way round, by project() alone: the picture's edge lies where the lens puts the box's edge.
TEST(VirtualCell, DistortedEdgeLiesWhereTheCameraProjectsIt) {
  const CameraModel camera{321, 241, 220, 220, 160, 120, {0.3, -0.2, 0, 0, 0.05}};
  const double right = 0.6;
  const RobotModel robot = robot_from(link("base", box_shape({0.4, 1.2, 0.2}, shift(right - 0.2, 0, 1.1))));
  const VirtualMeasurement m = measured(VirtualCell(robot), camera, Pose::Identity());
  CameraModel ideal = camera;
  ideal.distortion = {0, 0, 0, 0, 0};
  for (const double y_m : {-0.45, -0.2, 0.0, 0.3, 0.45}) {
    const Eigen::Vector2d edge = camera.project({right, y_m, 1.0});
    const int row = static_cast<int>(std::lround(edge.y()));
    EXPECT_NEAR(last_column(m, row), edge.x() - 0.5, 0.6) << y_m;
    EXPECT_GT(std::abs(edge.x() - ideal.project({right, y_m, 1.0}).x()), 5);  // the lens matters here
  }
}

TEST(VirtualCell, HitAlongARayEqualsMeasureAtPixelCentres) {
  const RobotModel robot = robot_from(link("base", box_shape({0.4, 0.3, 0.5}, shift(0.1, 0.05, 0.3))));
  const CameraModel camera{161, 121, 110, 112, 78.2, 61.3, {0.09, -0.27, 0.002, -0.001, 0.09}};
  const VirtualCell cell(robot);
  const VirtualMeasurement m = measured(cell, camera, skew_pose());
  int hits = 0;
  for (int y = 0; y < camera.height; y += 2) {
    for (int x = 0; x < camera.width; x += 2) {
      const SurfaceHit hit = cell.hit_along(camera.ray(x, y), skew_pose());
      EXPECT_NEAR(hit.depth_m, m.depth_m[pixel(m, x, y)], 2e-6F) << x << ' ' << y;
      EXPECT_LT((hit.normal - m.normal[pixel(m, x, y)]).norm(), 1e-5F) << x << ' ' << y;
      hits += hit.depth_m > 0;
    }
  }
  EXPECT_GT(hits, 300);
}

}  // namespace
}  // namespace calibrd
