// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/robot_model.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/robot/robot_model_builder.hpp"
#include "core/robot/urdf_file.hpp"

namespace calibrd {
namespace {

/// The joint's motion: joint frame at `position` in the joint frame at 0.
Pose motion(const Joint& joint, double position) {
  Pose T_joint_moved = Pose::Identity();
  if (joint.type == JointType::prismatic)
    T_joint_moved.translation() = position * joint.axis;
  else if (joint.type != JointType::fixed)
    T_joint_moved.linear() = Eigen::AngleAxisd(position, joint.axis).toRotationMatrix();
  return T_joint_moved;
}

void check_count(const char* what, std::size_t given, std::size_t wanted) {
  if (given != wanted)
    throw std::invalid_argument(std::string("forward kinematics: ") + what + " has " + std::to_string(given) +
                                " elements, the robot model needs " + std::to_string(wanted));
}

}  // namespace

Result<RobotModel> RobotModel::load(const std::filesystem::path& urdf, const RobotModelOptions& options) {
  const auto source = read_urdf(urdf);
  if (!source) return source.error();
  return RobotModelBuilder(**source, urdf, options).build();
}

std::vector<std::size_t> RobotModel::tip_links() const {
  std::vector<bool> is_end(links_.size(), true);
  for (const Joint& joint : joints_) is_end[static_cast<std::size_t>(joint.parent_link)] = false;
  std::vector<std::size_t> tips;
  for (std::size_t link = 0; link < links_.size(); ++link)
    if (is_end[link] && links_[link].parent_joint >= 0) tips.push_back(link);
  return tips;
}

std::vector<Pose> RobotModel::forward_kinematics(std::span<const double> positions) const {
  std::vector<Pose> T_base_link(links_.size());
  forward_kinematics_into(positions, T_base_link);
  return T_base_link;
}

void RobotModel::forward_kinematics_into(std::span<const double> positions,
                                         std::span<Pose> T_base_link) const {
  check_count("positions", positions.size(), position_count());
  check_count("T_base_link", T_base_link.size(), links_.size());
  T_base_link[0] = Pose::Identity();  // so far T_root_link: parents come before children
  for (std::size_t index = 0; index < joints_.size(); ++index) {
    const Joint& joint = joints_[index];
    const auto child = static_cast<std::size_t>(joint.child_link),
               parent = static_cast<std::size_t>(joint.parent_link);
    T_base_link[child] =
        T_base_link[parent] * joint.T_parent_joint * motion(joint, drives_[index].position(positions));
  }
  if (base_link_ == 0) return;
  const Pose T_base_root = T_base_link[static_cast<std::size_t>(base_link_)].inverse();
  for (Pose& T_root_link : T_base_link) T_root_link = T_base_root * T_root_link;
}

std::optional<int> RobotModel::find_link(std::string_view name) const {
  const auto found =
      std::ranges::find(links_, name, [](const Link& link) { return std::string_view(link.name); });
  if (found == links_.end()) return std::nullopt;
  return static_cast<int>(found - links_.begin());
}

}  // namespace calibrd
