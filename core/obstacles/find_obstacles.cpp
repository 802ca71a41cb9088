// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/obstacles/find_obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/obstacles/obstacle_clusters.hpp"

namespace calibrd {
namespace {

/// Neighbouring cells of one surface differ by less than this times the distance between them: 76°.
constexpr double kSlope = 4;

}  // namespace

/// One frame, and what of it is foreign.
struct ObstacleFinder::Frame {
  const DepthImage& depth;
  ExpectedCells expected;
  const Pose& T_base_sensor;
  const DepthCorrection& correction;
  std::vector<Foreign> foreign;

  const CameraModel& grid() const { return expected.background.grid(); }
  int column(std::uint32_t cell) const { return static_cast<int>(cell) % grid().width; }
  int row(std::uint32_t cell) const { return static_cast<int>(cell) / grid().width; }

  Eigen::Vector3d point_base(const Eigen::Vector3d& direction, double measured_m) const {
    return T_base_sensor * (correction.truth(measured_m) * direction);
  }
  /// Neighbouring cells of one surface differ by less.
  double step_m(std::uint32_t cell) const {
    const double z = depth.depth_m(kBackgroundStride * column(cell), kBackgroundStride * row(cell));
    return kSlope * z / grid().fx;
  }
  std::vector<Eigen::Vector3d> points_around(std::uint32_t cell, const CameraModel& camera) const;
  Eigen::Vector3d point_base(std::uint32_t cell, const CameraModel& camera) const {
    const int x = column(cell), y = row(cell);
    const double z = surface_depth_m(depth, camera, kBackgroundStride * x, kBackgroundStride * y);
    return point_base(expected.background.rays().at(x, y), z);
  }
};

/// Of the foreign pixels between a cell and its neighbours.
std::vector<Eigen::Vector3d> ObstacleFinder::Frame::points_around(std::uint32_t cell,
                                                                  const CameraModel& camera) const {
  const int column0 = kBackgroundStride * column(cell), row0 = kBackgroundStride * row(cell);
  const double z = depth.depth_m(column0, row0), step = step_m(cell);
  std::vector<Eigen::Vector3d> points;
  for (int y = row0 - kBackgroundStride; y <= row0 + kBackgroundStride; ++y)
    for (int x = column0 - kBackgroundStride; x <= column0 + kBackgroundStride; ++x) {
      if (x < 0 || y < 0 || x >= depth.width || y >= depth.height) continue;
      const double there = surface_depth_m(depth, camera, x, y);
      if (there <= 0 || std::abs(there - z) > step || may_be_known(expected, camera, x, y, there)) continue;
      points.push_back(point_base(camera.ray(x, y), there));
    }
  return points;
}

std::vector<Obstacle> ObstacleFinder::find(const View& view, const BackgroundMap& background,
                                           const Pose& T_base_sensor, const DepthCorrection& correction) {
  BackgroundMatcher matcher(background);
  const auto& mask = robot_.at(view.joint_positions_rad, T_base_sensor);
  matcher.match(view.depth, mask, T_base_sensor.linear());
  Frame frame{view.depth,
              {background, matcher.states(), robot_around(mask, robot_.prediction())},
              T_base_sensor,
              correction,
              {}};
  frame.foreign = foreign_cells(frame.expected, camera_, view.depth);
  std::vector<float> depth_m = matcher.depth_m();
  for (std::size_t i = 0; i < depth_m.size(); ++i)
    if (frame.foreign[i] == Foreign::no) depth_m[i] = 0;
  const CameraModel& grid = background.grid();
  std::vector<Obstacle> obstacles;
  for (const auto& cluster :
       depth_clusters(depth_m, grid.width, static_cast<float>(kSlope / grid.fx), settings_.least_points))
    obstacles.push_back(describe(frame, cluster));
  std::ranges::sort(obstacles, {}, &Obstacle::distance_m);
  return obstacles;
}

Obstacle ObstacleFinder::describe(const Frame& frame, const std::vector<std::uint32_t>& cluster) const {
  Obstacle obstacle;
  obstacle.points = cluster.size();
  std::vector<Eigen::Vector3d> points_base;
  for (const std::uint32_t cell : cluster) {
    points_base.push_back(frame.point_base(cell, camera_));
    obstacle.box_base.extend(points_base.back());
    obstacle.centre_base += points_base.back() / static_cast<double>(cluster.size());
    if (frame.foreign[cell] == Foreign::before_known)
      obstacle.before_known_share += 1 / static_cast<double>(cluster.size());
  }
  obstacle.near_tool = is_near_tool(points_base);
  measure_distance(frame, cluster, obstacle);
  return obstacle;
}

/// On the grid first; then, where the nearest point may lie between its cells, on all pixels.
void ObstacleFinder::measure_distance(const Frame& frame, const std::vector<std::uint32_t>& cluster,
                                      Obstacle& obstacle) const {
  const VirtualCell& robot = robot_.cell();
  obstacle.distance_m = std::numeric_limits<double>::infinity();
  const auto look_at = [&](const Eigen::Vector3d& point_base) {
    const auto nearest = robot.nearest_surface(point_base, obstacle.distance_m);
    if (!nearest) return;
    obstacle.distance_m = nearest->distance_m;
    obstacle.link = nearest->link;
    obstacle.nearest_base = point_base;
    obstacle.nearest_robot_base = nearest->point_base;
  };
  std::vector<Eigen::Vector3d> points_base;
  for (const std::uint32_t cell : cluster) {
    points_base.push_back(frame.point_base(cell, camera_));
    look_at(points_base.back());
  }
  const double on_grid_m = obstacle.distance_m;
  for (std::size_t i = 0; i < cluster.size(); ++i)
    if (robot.nearest_surface(points_base[i], on_grid_m + frame.step_m(cluster[i])))
      for (const Eigen::Vector3d& point_base : frame.points_around(cluster[i], camera_)) look_at(point_base);
}

bool ObstacleFinder::is_near_tool(const std::vector<Eigen::Vector3d>& points_base) const {
  const double reach = settings_.tool_reach_m * settings_.tool_reach_m;
  for (const std::size_t link : robot_.cell().robot().tip_links()) {
    const Eigen::Vector3d tip_base = robot_.cell().link_poses()[link].translation();
    if (std::ranges::all_of(points_base, [&](const auto& p) { return (p - tip_base).squaredNorm() < reach; }))
      return true;
  }
  return false;
}

}  // namespace calibrd
