// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/setting.hpp"

#include <algorithm>

namespace calibrd {
namespace {

std::vector<Names> joint_names(const Config& config) {
  std::vector<Names> all;
  for (const auto& [joint, unused] : config.robot.joints) all.push_back({joint});
  return all;
}

std::vector<Names> coupling_names(const Config& config) {
  std::vector<Names> all;
  for (const auto& [joint, settings] : config.robot.joints)
    for (const auto& [other, unused] : settings.coupling) all.push_back({joint, other});
  return all;
}

std::vector<Names> sensor_names(const Config& config) {
  std::vector<Names> all;
  for (const auto& [id, unused] : config.sensors) all.push_back({id});
  return all;
}

std::vector<Names> workspace_names(const Config& config) {
  std::vector<Names> all;
  for (const auto& [id, settings] : config.sensors)
    for (const auto& [point, unused] : settings.workspace) all.push_back({id, point});
  return all;
}

std::vector<Names> route_names(const Config& config) {
  std::vector<Names> all;
  for (const auto& [name, unused] : config.motion.routes) all.push_back({name});
  return all;
}

}  // namespace

std::vector<Names> instances(const Setting& setting, const Config& config) {
  const auto stars = std::count(setting.path.begin(), setting.path.end(), "*");
  if (stars == 0) return {Names{}};
  if (setting.path.front() == "motion") return route_names(config);
  if (setting.path.front() == "sensors") return stars == 1 ? sensor_names(config) : workspace_names(config);
  return stars == 1 ? joint_names(config) : coupling_names(config);
}

std::vector<std::string> path_of(const Setting& setting, const Names& names) {
  auto path = setting.path;
  std::size_t next = 0;
  for (auto& part : path)
    if (part == "*") part = names.at(next++);
  return path;
}

}  // namespace calibrd
