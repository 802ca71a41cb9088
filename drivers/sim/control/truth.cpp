// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/control/truth.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/sim/model/settings_json.hpp"

namespace calibrd::sim {

namespace json = boost::json;

namespace {

json::array joints_json(const Joints& joints, std::size_t count) {
  return json::array(joints.begin(), joints.begin() + static_cast<std::ptrdiff_t>(count));
}

json::object sensor_json(const SensorState& sensor) {
  return {{"id", sensor.id.data()},
          {"T_base_sensor", to_json(sensor.T_base_sensor.pose())},
          {"camera", camera_json(sensor.camera)},
          {"rate_hz", sensor.rate_hz},
          {"latency_s", sensor.latency_s},
          {"depth_errors", depth_errors_json(sensor.depth)},
          {"infrared", infrared_errors_json(sensor.infrared)},
          {"mode", kSensorModes[static_cast<int>(sensor.mode)]},
          {"crashes", sensor.crashes},
          {"powered_ns", sensor.powered_ns}};
}

json::object motion_json(const WorldState& state, std::size_t joints, std::int64_t at_ns) {
  constexpr double kMoving_rad_s = 1e-4;
  const Joints speeds = state.motion.velocities_at(at_ns);
  const bool moving =
      std::any_of(speeds.begin(), speeds.end(), [](double speed) { return std::abs(speed) > kMoving_rad_s; });
  return {{"moving", moving}, {"velocities_rad_s", joints_json(speeds, joints)}};
}

}  // namespace

json::object truth_json(const Cell& cell, const WorldState& state, std::int64_t at_ns) {
  const std::size_t joints = cell.robot.positions.size();
  json::array names, sensors, objects;
  for (const auto& range : cell.robot.positions) names.emplace_back(range.name);
  for (std::size_t i = 0; i < static_cast<std::size_t>(state.sensor_count); ++i)
    sensors.push_back(sensor_json(state.sensors[i]));
  for (std::size_t i = 0; i < cell.objects.size(); ++i)
    objects.push_back({{"name", cell.objects[i].name},
                       {"present", state.objects[i].present != 0},
                       {"T_base_object", to_json(state.objects[i].T_base_object.pose())}});
  return {{"time_ns", at_ns},
          {"base_link", cell.robot.links[static_cast<std::size_t>(cell.robot.base_link)].name},
          {"joint_names", std::move(names)},
          {"joints_rad", joints_json(state.motion.positions_at(at_ns), joints)},
          {"joints_reported_rad", joints_json(state.reported_at(at_ns), joints)},
          {"joint_zero_rad", joints_json(state.joint_zero_rad, joints)},
          {"motion", motion_json(state, joints, at_ns)},
          {"sensors", std::move(sensors)},
          {"objects", std::move(objects)},
          {"person", {{"present", state.person.present != 0}}},
          {"other_robot",
           {{"present", state.other_robot.present != 0},
            {"T_base_other", to_json(state.other_robot.T_base_other.pose())},
            {"joints_rad", joints_json(state.other_robot.joints, joints)}}}};
}

}  // namespace calibrd::sim
