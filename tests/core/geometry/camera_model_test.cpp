// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/camera_model.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

CameraModel kinect2() {
  return {512, 424, 365.456, 365.456, 254.878, 205.395, {0.0905, -0.268, 0.001, -0.0005, 0.0951}};
}

TEST(CameraModel, ProjectUndoesRayInEveryCorner) {
  for (double u : {0.0, 255.0, 511.0}) {
    for (double v : {0.0, 212.0, 423.0}) {
      const Eigen::Vector2d seen = kinect2().project(1.7 * kinect2().ray(u, v));
      EXPECT_LT((seen - Eigen::Vector2d(u, v)).norm(), 1e-9) << u << ' ' << v;
    }
  }
}

TEST(CameraModel, IgnoredDistortionOfAKinectIsMoreThanAPixel) {
  CameraModel ideal = kinect2();
  ideal.distortion = {0, 0, 0, 0, 0};
  const Eigen::Vector3d point(0.4, 0, 1.0);  // 146 px from the centre
  EXPECT_GT((kinect2().project(point) - ideal.project(point)).norm(), 1.0);
}

TEST(CameraModel, JacobianMatchesFiniteDifferences) {
  const Eigen::Vector3d point(0.3, -0.25, 1.34);
  const auto jacobian = kinect2().projection_jacobian(point);
  for (int k = 0; k < 3; ++k) {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    step[k] = 1e-6;
    const Eigen::Vector2d slope = (kinect2().project(point + step) - kinect2().project(point - step)) / 2e-6;
    EXPECT_LT((jacobian.col(k) - slope).norm(), 1e-4);
  }
}

TEST(CameraModel, EveryNthPixelSeesWhatItSawBefore) {
  CameraModel camera;
  camera.width = 321;
  camera.height = 241;
  camera.fx = 300;
  camera.fy = 290;
  camera.cx = 158.3;
  camera.cy = 121.7;
  camera.distortion = {0.08, -0.2, 0.001, -0.0005, 0.05};
  for (const int step : {2, 3, 4}) {
    const CameraModel sparse = camera.subsampled(step);
    EXPECT_EQ((sparse.width - 1) * step, (camera.width - 1) / step * step);
    for (const auto& [x, y] : {std::pair{0, 0}, {sparse.width - 1, sparse.height - 1}, {7, 31}})
      EXPECT_TRUE(sparse.ray(x, y).isApprox(camera.ray(x * step, y * step), 1e-9)) << step;
  }
}

TEST(CameraModel, BinnedPixelSeesWhereItsBlockHasItsMiddle) {
  const CameraModel camera = kinect2();
  for (const int side : {2, 4, 8}) {
    const CameraModel binned = camera.binned(side);
    EXPECT_EQ(binned.width, camera.width / side);
    EXPECT_EQ(binned.height, camera.height / side);
    const double middle = (side - 1) / 2.0;
    for (const auto& [x, y] : {std::pair{0, 0}, {binned.width - 1, binned.height - 1}, {11, 17}})
      EXPECT_TRUE(binned.ray(x, y).isApprox(camera.ray(x * side + middle, y * side + middle), 1e-9)) << side;
  }
}

}  // namespace
}  // namespace calibrd
