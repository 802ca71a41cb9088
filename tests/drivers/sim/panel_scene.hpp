// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <numbers>

#include "tests/drivers/sim/sim_fixtures.hpp"

namespace calibrd::sim::test {

/// A cell without a robot: panels before a sensor that stands in the base frame's origin, looking along its
/// z.
struct PanelScene {
  Cell cell;
  WorldState state;

  PanelScene() {
    state.sensor_count = 1;
    state.sensors[0].powered_ns = 0;
  }

  /// A thin box whose face towards the sensor has its middle at `middle`; turned about its own y axis.
  void add_panel(const Eigen::Vector3d& middle, const Eigen::Vector2d& size, double turn_rad = 0,
                 float albedo = 1) {
    const auto index = static_cast<std::size_t>(state.object_count++);
    Mesh mesh = make_box({size.x(), size.y(), 0.02});
    for (auto& vertex : mesh.vertices) vertex.z() += 0.01F;  // the face itself passes through the origin
    cell.objects.push_back({"panel", mesh, {albedo, 0, 1}});
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
    pose.translation() = middle;
    state.objects[index] = {PoseValues::of(pose), 1};
  }

  SensorState& sensor() { return state.sensors[0]; }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(state.sensors[0].camera.width) +
           static_cast<std::size_t>(x);
  }
};

/// A panel that fills the view at a distance, turned about the vertical.
inline PanelScene wall(double distance_m, double turn_rad = 0) {
  PanelScene scene;
  scene.add_panel({0, 0, distance_m}, {60, 60}, turn_rad);
  return scene;
}

}  // namespace calibrd::sim::test
