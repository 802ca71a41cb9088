// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/model_views.hpp"

#include <algorithm>

#include "core/capture/capture_error.hpp"

namespace calibrd {
namespace {

std::string listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

/// For each joint of the model, its place in the recording.
Result<std::vector<std::size_t>> find_order(const RobotModel& robot,
                                            const std::vector<std::string>& recorded) {
  const auto& needed = robot.position_names();
  for (const std::string& name : recorded) {
    if (std::ranges::find(needed, name) == needed.end())
      return fail(CaptureError::unknown_joint, "\"" + name + "\" (the model has: " + listed(needed) + ")");
    if (std::ranges::count(recorded, name) > 1)
      return fail(CaptureError::duplicate_joint, "\"" + name + "\"");
  }
  std::vector<std::size_t> order;
  for (const std::string& name : needed) {
    const auto found = std::ranges::find(recorded, name);
    if (found == recorded.end())
      return fail(CaptureError::missing_joint,
                  "\"" + name + "\" (the recording has: " + listed(recorded) + ")");
    order.push_back(static_cast<std::size_t>(found - recorded.begin()));
  }
  return order;
}

}  // namespace

Result<std::vector<View>> views_in_model_order(const RobotModel& robot, Capture capture) {
  const auto order = find_order(robot, capture.joint_names);
  if (!order) return order.error();
  for (View& view : capture.views) {
    std::vector<double> positions;
    for (const std::size_t place : *order) positions.push_back(view.joint_positions_rad[place]);
    view.joint_positions_rad = std::move(positions);
  }
  return std::move(capture.views);
}

}  // namespace calibrd
