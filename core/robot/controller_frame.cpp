// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/controller_frame.hpp"

#include <algorithm>
#include <vector>

#include "core/robot/nearest_name.hpp"
#include "core/robot/robot_model.hpp"
#include "core/robot/robot_model_error.hpp"

namespace calibrd {
namespace {

Error no_such_link(const RobotModel& model, std::string_view wanted) {
  std::vector<std::string> names;
  for (const auto& link : model.links()) names.push_back(link.name);
  const std::string name(wanted);
  return {RobotModelError::unknown_link, "'" + name + "' (" + name_hint(name, names) + ")"};
}

Error moving_link(const RobotModel& model, std::string_view link, const Joint& joint) {
  std::string detail = "'";
  detail.append(link).append("' (by joint '" + joint.name + "', seen from '" + model.base_link() + "')");
  return {RobotModelError::link_moves, detail};
}

/// The joints from a link to the root of the model, as indices.
std::vector<int> joints_above(const RobotModel& model, int link) {
  std::vector<int> joints;
  int joint = model.links()[static_cast<std::size_t>(link)].parent_joint;
  while (joint >= 0) {
    joints.push_back(joint);
    const auto parent = static_cast<std::size_t>(model.joints()[static_cast<std::size_t>(joint)].parent_link);
    joint = model.links()[parent].parent_joint;
  }
  std::sort(joints.begin(), joints.end());
  return joints;
}

/// The joints on the way between two links: those above one of them, not above both.
std::vector<int> joints_between(const RobotModel& model, int first, int second) {
  const auto of_first = joints_above(model, first), of_second = joints_above(model, second);
  std::vector<int> between;
  std::set_symmetric_difference(of_first.begin(), of_first.end(), of_second.begin(), of_second.end(),
                                std::back_inserter(between));
  return between;
}

}  // namespace

Result<ControllerFrame> find_controller_frame(const RobotModel& model, std::string_view link) {
  const auto found = model.find_link(link), base = model.find_link(model.base_link());
  if (!found) return no_such_link(model, link);
  for (const int joint : joints_between(model, *found, *base))
    if (model.drives()[static_cast<std::size_t>(joint)].position_index >= 0)
      return moving_link(model, link, model.joints()[static_cast<std::size_t>(joint)]);
  const std::vector<double> anywhere(model.position_count(), 0.0);
  return ControllerFrame{std::string(link),
                         model.forward_kinematics(anywhere)[static_cast<std::size_t>(*found)]};
}

}  // namespace calibrd
