// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/core/robot/kdl_oracle.hpp"

#include <fstream>
#include <iterator>
#include <kdl/treefksolverpos_recursive.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

namespace calibrd::test {
namespace {

struct JointText {
  std::string name, type, parent, child;
  KDL::Frame origin;
  KDL::Vector axis{1, 0, 0};
};

/// What stands between `before` and `after`, first occurrence from `start`.
std::optional<std::string> between(const std::string& text, const std::string& before,
                                   const std::string& after, std::size_t start = 0) {
  const auto from = text.find(before, start);
  if (from == std::string::npos) return std::nullopt;
  const auto to = text.find(after, from + before.size());
  return text.substr(from + before.size(), to - from - before.size());
}

/// The value of an attribute in the first tag of that name, or `otherwise`.
std::string attribute(const std::string& text, const std::string& tag, const std::string& name,
                      const std::string& otherwise) {
  const auto inside = between(text, "<" + tag + " ", ">");
  return inside ? between(" " + *inside, " " + name + "=\"", "\"").value_or(otherwise) : otherwise;
}

KDL::Vector vector_of(const std::string& text) {
  std::istringstream stream(text);
  double x = 0, y = 0, z = 0;
  stream >> x >> y >> z;
  return {x, y, z};
}

JointText read_joint(const std::string& text) {
  const KDL::Vector rpy = vector_of(attribute(text, "origin", "rpy", "0 0 0"));
  JointText joint;
  joint.name = attribute(text, "joint", "name", "");
  joint.type = attribute(text, "joint", "type", "");
  joint.parent = attribute(text, "parent", "link", "");
  joint.child = attribute(text, "child", "link", "");
  joint.origin = {KDL::Rotation::RPY(rpy.x(), rpy.y(), rpy.z()),
                  vector_of(attribute(text, "origin", "xyz", "0 0 0"))};
  joint.axis = vector_of(attribute(text, "axis", "xyz", "1 0 0"));
  return joint;
}

std::vector<JointText> read_joints(const std::filesystem::path& urdf) {
  std::ifstream stream(urdf);
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  std::vector<JointText> joints;
  for (auto start = text.find("<joint "); start != std::string::npos; start = text.find("<joint ", start + 1))
    joints.push_back(read_joint("<joint " + between(text, "<joint ", "</joint>", start).value()));
  return joints;
}

KDL::Joint to_kdl(const JointText& joint) {
  if (joint.type == "fixed") return KDL::Joint(joint.name, KDL::Joint::None);
  const auto type = joint.type == "prismatic" ? KDL::Joint::TransAxis : KDL::Joint::RotAxis;
  return KDL::Joint(joint.name, joint.origin.p, joint.origin.M * joint.axis, type);
}

std::string root_of(const std::vector<JointText>& joints) {
  std::set<std::string> children;
  for (const auto& joint : joints) children.insert(joint.child);
  for (const auto& joint : joints)
    if (!children.contains(joint.parent)) return joint.parent;
  throw std::runtime_error("the URDF has no root");
}

Pose to_pose(const KDL::Frame& frame) {
  Pose pose = Pose::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) pose(row, column) = frame.M(row, column);
    pose(row, 3) = frame.p(row);
  }
  return pose;
}

}  // namespace

KdlOracle::KdlOracle(const std::filesystem::path& urdf) {
  auto waiting = read_joints(urdf);
  root_ = root_of(waiting);
  tree_ = KDL::Tree(root_);
  while (!waiting.empty()) {  // addSegment() refuses a child whose parent is not there yet
    const auto added = std::erase_if(waiting, [this](const JointText& joint) {
      return tree_.addSegment(KDL::Segment(joint.child, to_kdl(joint), joint.origin), joint.parent);
    });
    if (added == 0) throw std::runtime_error("the URDF is not a tree");
  }
}

std::map<std::string, Pose> KdlOracle::link_poses(const std::map<std::string, double>& positions) const {
  KDL::JntArray values(tree_.getNrOfJoints());
  for (const auto& [link, element] : tree_.getSegments()) {
    const auto position = positions.find(element.segment.getJoint().getName());
    if (position != positions.end()) values(element.q_nr) = position->second;
  }
  KDL::TreeFkSolverPos_recursive solver(tree_);
  std::map<std::string, Pose> poses{{root_, Pose::Identity()}};
  for (const auto& [link, element] : tree_.getSegments()) {
    KDL::Frame frame;
    if (link != root_ && solver.JntToCart(values, frame, link) == 0) poses[link] = to_pose(frame);
  }
  return poses;
}

}  // namespace calibrd::test
