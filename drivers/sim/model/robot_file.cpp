// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/model/robot_file.hpp"

#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>

#include "drivers/sim/model/mesh_file.hpp"
#include "drivers/sim/world/motion.hpp"
#include "drivers/sim/world/sim_error.hpp"

namespace calibrd::sim {
namespace {

namespace fs = std::filesystem;

Eigen::Vector3d vector_of(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Eigen::Isometry3d pose_of(const urdf::Pose& pose) {
  const urdf::Rotation& q = pose.rotation;
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  result.translation() = vector_of(pose.position);
  return result;
}

std::optional<fs::path> find_mesh(const std::string& name, const fs::path& urdf,
                                  const RobotFileOptions& options) {
  constexpr std::string_view kPackage = "package://", kFile = "file://";
  std::string relative = name;
  if (name.starts_with(kPackage)) relative = name.substr(kPackage.size());
  if (name.starts_with(kFile)) relative = name.substr(kFile.size());
  std::vector<fs::path> folders;
  for (fs::path folder = fs::absolute(urdf).parent_path();; folder = folder.parent_path()) {
    folders.push_back(folder);
    if (folder == folder.root_path()) break;
  }
  folders.insert(folders.end(), options.models.begin(), options.models.end());
  std::error_code ignored;
  for (const auto& folder : folders)
    if (fs::is_regular_file(folder / relative, ignored)) return folder / relative;
  return std::nullopt;
}

Result<Mesh> mesh_of(const urdf::Geometry& geometry, const fs::path& urdf, const RobotFileOptions& options) {
  if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry)) return make_box(vector_of(box->dim));
  if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry))
    return make_cylinder(cylinder->radius, cylinder->length, 48);
  if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry))
    return make_capsule(sphere->radius, 0, 48);
  const auto* mesh = dynamic_cast<const urdf::Mesh*>(&geometry);
  if (mesh == nullptr) return Mesh{};
  const auto path = find_mesh(mesh->filename, urdf, options);
  if (!path) return sim_error(SimError::mesh_not_found, mesh->filename);
  return read_mesh(*path, vector_of(mesh->scale));
}

/// The link's visual geometry, or its collision geometry where it has no visual one.
Result<Mesh> surface_of(const urdf::Link& link, const fs::path& urdf, const RobotFileOptions& options) {
  std::vector<std::pair<urdf::Pose, urdf::GeometrySharedPtr>> parts;
  for (const auto& visual : link.visual_array) parts.emplace_back(visual->origin, visual->geometry);
  if (parts.empty())
    for (const auto& collision : link.collision_array)
      parts.emplace_back(collision->origin, collision->geometry);
  Mesh whole;
  for (const auto& [origin, geometry] : parts) {
    if (!geometry) continue;
    auto part = mesh_of(*geometry, urdf, options);
    if (!part) return part.error();
    const Eigen::Isometry3f T_link_part = pose_of(origin).cast<float>();
    for (auto& vertex : part->vertices) vertex = T_link_part * vertex;
    append(whole, *part);
  }
  return whole;
}

/// Adds the links below `link` in tree order.
class TreeReader {
 public:
  TreeReader(Robot& robot, const fs::path& urdf, const RobotFileOptions& options)
      : robot_(robot), urdf_(urdf), options_(options) {}

  Status add_link(const urdf::Link& link, int parent_joint) {
    auto mesh = surface_of(link, urdf_, options_);
    if (!mesh) return mesh.error();
    const int index = static_cast<int>(robot_.links.size());
    robot_.links.push_back({link.name, parent_joint, std::move(*mesh), {}});
    if (link.name == options_.base_link) robot_.base_link = index;
    for (const auto& joint : link.child_joints) {
      const int joint_index = add_joint(*joint, index);
      robot_.joints[static_cast<std::size_t>(joint_index)].child_link = static_cast<int>(robot_.links.size());
      for (const auto& child : link.child_links)
        if (child->name == joint->child_link_name)
          if (auto added = add_link(*child, joint_index); !added) return added;
    }
    return Done{};
  }

  /// Mimic joints may name a joint that comes later in the tree.
  void resolve_mimics() {
    for (const auto& [joint, mimic] : mimics_) {
      RobotJoint& follower = robot_.joints[joint];
      for (const auto& leader : robot_.joints)
        if (leader.name == mimic->joint_name) follower.position = leader.position;
      follower.multiplier = mimic->multiplier;
      follower.offset = mimic->offset;
      if (follower.position < 0) follower.movement = Movement::fixed;
    }
  }

 private:
  int add_joint(const urdf::Joint& source, int parent_link) {
    RobotJoint joint;
    joint.name = source.name;
    joint.parent_link = parent_link;
    joint.T_parent_joint = pose_of(source.parent_to_joint_origin_transform);
    if (source.type == urdf::Joint::PRISMATIC) joint.movement = Movement::sliding;
    if (source.type == urdf::Joint::REVOLUTE || source.type == urdf::Joint::CONTINUOUS)
      joint.movement = Movement::turning;
    if (joint.movement != Movement::fixed) {
      joint.axis = vector_of(source.axis).normalized();
      if (source.mimic)
        mimics_[robot_.joints.size()] = source.mimic;
      else
        joint.position = add_position(source);
    }
    robot_.joints.push_back(joint);
    return static_cast<int>(robot_.joints.size()) - 1;
  }

  int add_position(const urdf::Joint& source) {
    PositionRange range{source.name, -std::numbers::pi, std::numbers::pi};
    if (source.limits && source.limits->upper > source.limits->lower) {
      range.lower = source.limits->lower;
      range.upper = source.limits->upper;
    }
    robot_.positions.push_back(range);
    return static_cast<int>(robot_.positions.size()) - 1;
  }

  Robot& robot_;
  const fs::path& urdf_;
  const RobotFileOptions& options_;
  std::map<std::size_t, urdf::JointMimicSharedPtr> mimics_;
};

}  // namespace

Result<Robot> read_robot(const fs::path& urdf, const RobotFileOptions& options) {
  std::ifstream file(urdf);
  const std::string xml{std::istreambuf_iterator<char>(file), {}};
  const auto model = xml.empty() ? nullptr : urdf::parseURDF(xml);
  if (!model || !model->getRoot()) return sim_error(SimError::urdf_unreadable, urdf.string());
  Robot robot;
  robot.name = model->getName();
  TreeReader reader(robot, urdf, options);
  if (auto read = reader.add_link(*model->getRoot(), -1); !read) return read.error();
  reader.resolve_mimics();
  if (robot.positions.empty()) return sim_error(SimError::no_joints, urdf.string());
  if (robot.positions.size() > kMaxJoints) return sim_error(SimError::too_large, urdf.string());
  return robot;
}

}  // namespace calibrd::sim
