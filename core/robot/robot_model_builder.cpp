// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/robot_model_builder.hpp"

#include <urdf_model/joint.h>
#include <urdf_model/link.h>
#include <urdf_model/model.h>

#include <algorithm>
#include <optional>

#include "core/robot/link_surface.hpp"
#include "core/robot/nearest_name.hpp"
#include "core/robot/robot_model_error.hpp"
#include "core/robot/urdf_pose.hpp"

namespace calibrd {
namespace {

std::optional<JointType> joint_type(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
      return JointType::revolute;
    case urdf::Joint::CONTINUOUS:
      return JointType::continuous;
    case urdf::Joint::PRISMATIC:
      return JointType::prismatic;
    case urdf::Joint::FIXED:
      return JointType::fixed;
    default:
      return std::nullopt;
  }
}

const char* unsupported_type(const urdf::Joint& joint) {
  if (joint.type == urdf::Joint::FLOATING) return "floating";
  return joint.type == urdf::Joint::PLANAR ? "planar" : "of unknown type";
}

std::optional<JointLimits> limits_of(const urdf::Joint& joint) {
  if (!joint.limits || joint.type == urdf::Joint::CONTINUOUS) return std::nullopt;
  return JointLimits{joint.limits->lower, joint.limits->upper};
}

template <class Items>
std::vector<std::string> names_of(const Items& items) {
  std::vector<std::string> names;
  names.reserve(items.size());
  for (const auto& item : items) names.push_back(item.name);
  return names;
}

template <class Items>
int index_of(const Items& items, std::string_view name) {
  const auto found =
      std::ranges::find(items, name, [](const auto& item) { return std::string_view(item.name); });
  return found == items.end() ? -1 : static_cast<int>(found - items.begin());
}

}  // namespace

Result<RobotModel> RobotModelBuilder::build() {
  model_.name_ = source_.getName();
  if (auto status = add_branch(*source_.getRoot(), -1); !status) return status.error();
  if (auto status = check_tree(); !status) return status.error();
  if (auto status = link_mimics(); !status) return status.error();
  if (auto status = set_drives(); !status) return status.error();
  if (auto status = choose_base(); !status) return status.error();
  if (auto status = read_surfaces(); !status) return status.error();
  return std::move(model_);
}

Error RobotModelBuilder::at_joint(RobotModelError code, const std::string& joint,
                                  const std::string& what) const {
  return {code, urdf_.string() + ", joint '" + joint + "'" + (what.empty() ? "" : " " + what)};
}

Status RobotModelBuilder::add_branch(const urdf::Link& link, int parent_joint) {
  // A link seen before has two parents (or is its own ancestor).
  if (index_of(model_.links_, link.name) >= 0)
    return Error{RobotModelError::not_a_tree,
                 urdf_.string() + ", link '" + link.name + "' has more than one parent"};
  const auto index = static_cast<int>(model_.links_.size());
  model_.links_.push_back({link.name, parent_joint, {}});
  for (const auto& joint : link.child_joints)
    if (auto status = add_joint(*joint, index); !status) return status;
  return Done{};
}

Status RobotModelBuilder::add_joint(const urdf::Joint& source, int parent_link) {
  const auto type = joint_type(source);
  if (!type)
    return at_joint(RobotModelError::unsupported_joint, source.name,
                    std::string("is ") + unsupported_type(source));
  Joint joint;
  joint.name = source.name;
  joint.type = *type;
  joint.parent_link = parent_link;
  joint.child_link = static_cast<int>(model_.links_.size());
  joint.T_parent_joint = to_pose(source.parent_to_joint_origin_transform);
  joint.limits = limits_of(source);
  if (!are_usable(joint.T_parent_joint.matrix()))
    return at_joint(RobotModelError::bad_number, joint.name, "<origin>");
  if (joint.type != JointType::fixed) {
    const Eigen::Vector3d axis = to_eigen(source.axis);
    if (!are_usable(axis)) return at_joint(RobotModelError::bad_number, joint.name, "<axis>");
    if (axis.stableNorm() < 1e-9) return at_joint(RobotModelError::bad_axis, joint.name);
    joint.axis = axis.stableNormalized();
  }
  const auto index = static_cast<int>(model_.joints_.size());
  model_.joints_.push_back(std::move(joint));
  const auto child = source_.getLink(source.child_link_name);
  if (!child) return at_joint(RobotModelError::not_a_tree, source.name, "has no child link");
  return add_branch(*child, index);
}

Status RobotModelBuilder::check_tree() const {
  // urdfdom accepts a ring of links beside the tree: its links are not reached from the root.
  for (const auto& [name, link] : source_.links_)
    if (index_of(model_.links_, name) < 0)
      return Error{RobotModelError::not_a_tree,
                   urdf_.string() + ", link '" + name + "' hangs on no link of the root's tree"};
  return Done{};
}

Status RobotModelBuilder::link_mimics() {
  for (Joint& joint : model_.joints_) {
    const auto& rule = source_.getJoint(joint.name)->mimic;
    if (!rule || joint.type == JointType::fixed) continue;
    const int followed = index_of(model_.joints_, rule->joint_name);
    if (followed < 0)
      return at_joint(RobotModelError::bad_mimic, joint.name,
                      "mimics unknown joint '" + rule->joint_name + "', " +
                          name_hint(rule->joint_name, names_of(model_.joints_)));
    if (!are_usable(Eigen::Vector2d(rule->multiplier, rule->offset)))
      return at_joint(RobotModelError::bad_number, joint.name, "<mimic>");
    joint.mimic = MimicRule{followed, rule->multiplier, rule->offset};
  }
  return Done{};
}

Status RobotModelBuilder::set_drives() {
  for (Joint& joint : model_.joints_)
    if (joint.type != JointType::fixed && !joint.mimic) {
      joint.position_index = static_cast<int>(model_.position_names_.size());
      model_.position_names_.push_back(joint.name);
    }
  for (std::size_t index = 0; index < model_.joints_.size(); ++index) {
    auto drive = drive_of(index);
    if (!drive) return drive.error();
    model_.drives_.push_back(*drive);
  }
  return Done{};
}

/// Follows a chain of mimic joints to the joint that moves by itself.
Result<JointDrive> RobotModelBuilder::drive_of(std::size_t index) const {
  const Joint* joint = &model_.joints_[index];
  if (joint->type == JointType::fixed) return JointDrive{};
  JointDrive drive;
  for (std::size_t steps = 0; joint->mimic; ++steps) {
    if (steps > model_.joints_.size())
      return at_joint(RobotModelError::bad_mimic, model_.joints_[index].name,
                      "mimics joints that in the end mimic each other");
    drive.offset += drive.multiplier * joint->mimic->offset;
    drive.multiplier *= joint->mimic->multiplier;
    joint = &model_.joints_[static_cast<std::size_t>(joint->mimic->joint)];
  }
  if (joint->type == JointType::fixed)
    return at_joint(RobotModelError::bad_mimic, model_.joints_[index].name,
                    "mimics the fixed joint '" + joint->name + "'");
  if (!are_usable(Eigen::Vector2d(drive.multiplier, drive.offset)))
    return at_joint(RobotModelError::bad_number, model_.joints_[index].name, "<mimic> of <mimic>");
  drive.position_index = joint->position_index;
  return drive;
}

Status RobotModelBuilder::choose_base() {
  if (options_.base_link.empty()) return Done{};
  model_.base_link_ = index_of(model_.links_, options_.base_link);
  if (model_.base_link_ >= 0) return Done{};
  return Error{RobotModelError::unknown_link, "base link '" + options_.base_link + "' in " + urdf_.string() +
                                                  ", " +
                                                  name_hint(options_.base_link, names_of(model_.links_))};
}

Status RobotModelBuilder::read_surfaces() {
  for (Link& link : model_.links_) {
    auto surface = read_link_surface(*source_.getLink(link.name), urdf_, options_);
    if (!surface) return surface.error();
    link.surface = std::move(*surface);
  }
  return Done{};
}

}  // namespace calibrd
