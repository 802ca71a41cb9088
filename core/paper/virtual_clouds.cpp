// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/paper/virtual_clouds.hpp"

#include <numbers>

#include "core/virtual_cell/surface_sampling.hpp"
#include "core/virtual_cell/virtual_cell.hpp"

namespace calibrd {
namespace {

constexpr int kSensors = 3;
constexpr std::size_t kSamplesForTheMiddle = 1000;

/// All points of a depth image, as `depth_m(x, y)` gives it, sensor frame.
template <class Depth>
Points points_of(const CameraModel& camera, Depth depth_m) {
  Points points;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      if (const double z = depth_m(x, y); z > 0) points.emplace_back((z * camera.ray(x, y)).cast<float>());
  return points;
}

Points seen_by(const VirtualCell& cell, const CameraModel& camera, const Pose& T_base_virtual) {
  VirtualMeasurement seen;
  cell.measure(camera, T_base_virtual, seen);
  return points_of(camera, [&](int x, int y) {
    return static_cast<double>(seen.depth_m[static_cast<std::size_t>(y * seen.width + x)]);
  });
}

}  // namespace

Points sampled_uniformly(const RobotModel& robot, const View& view, const PaperSettings& settings) {
  Points points;
  for (const SurfaceSample& sample :
       sample_surface(robot, view.joint_positions_rad, settings.model_points, settings.seed))
    points.emplace_back(sample.point.cast<float>());
  return points;
}

Points seen_by_three_sensors(const RobotModel& robot, const CameraModel& camera, const View& view,
                             const Pose& T_base_virtual) {
  PaperSettings few;
  few.model_points = kSamplesForTheMiddle;
  const Eigen::Translation3d middle(box_around(sampled_uniformly(robot, view, few)).center());
  VirtualCell cell(robot);
  cell.set_joints(view.joint_positions_rad);
  Points all;
  for (int i = 0; i < kSensors; ++i) {
    const Eigen::AngleAxisd turn(2 * std::numbers::pi * i / kSensors, Eigen::Vector3d::UnitZ());
    const Pose T_base_sensor = middle * turn * middle.inverse() * T_base_virtual;
    const Points seen = moved(T_base_sensor, seen_by(cell, camera, T_base_sensor));
    all.insert(all.end(), seen.begin(), seen.end());
  }
  return all;
}

Points measured_in(const Region& region, const CameraModel& camera, const View& view) {
  Points points = points_of(camera, [&](int x, int y) { return view.depth.depth_m(x, y); });
  std::erase_if(points, [&](const Eigen::Vector3f& p_sensor) {
    return !region.box.contains(region.T_box_sensor * p_sensor.cast<double>());
  });
  return points;
}

Points moved(const Pose& T_to_from, const Points& points_from) {
  Points points_to;
  points_to.reserve(points_from.size());
  for (const Eigen::Vector3f& p : points_from)
    points_to.emplace_back((T_to_from * p.cast<double>()).cast<float>());
  return points_to;
}

Eigen::AlignedBox3d box_around(const Points& points) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& p : points) box.extend(p.cast<double>());
  return box;
}

Eigen::AlignedBox3d region_of_robot(const Points& points_base, double margin_m) {
  Eigen::AlignedBox3d box = box_around(points_base);
  box.min() += margin_m * Eigen::Vector3d(-1, -1, 1);
  box.max().array() += margin_m;
  return box;
}

}  // namespace calibrd
