// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"
#include "core/geometry/pose.hpp"
#include "core/robot/triangle_mesh.hpp"

namespace calibrd {

enum class JointType { revolute, continuous, prismatic, fixed };

/// One link and its surface: visual geometry, or collision geometry where there is no visual one.
struct Link {
  std::string name;
  int parent_joint = -1;  ///< index into RobotModel::joints(); -1 for the root
  TriangleMesh surface;   ///< link frame, m; empty for a link without geometry
};

struct MimicRule {
  int joint = -1;  ///< index of the joint that is followed
  double multiplier = 1;
  double offset = 0;
};

struct JointLimits {
  double lower = 0, upper = 0;  ///< rad or m
};

struct Joint {
  std::string name;
  JointType type = JointType::fixed;
  int parent_link = -1;
  int child_link = -1;
  Pose T_parent_joint = Pose::Identity();           ///< joint frame in its parent link at position 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit vector, joint frame
  std::optional<JointLimits> limits;
  std::optional<MimicRule> mimic;
  int position_index = -1;  ///< index into the position vector; -1 for fixed and mimic joints
};

/// What moves a joint, mimic chains resolved: multiplier · positions[position_index] + offset; 0 for a fixed
/// joint.
struct JointDrive {
  int position_index = -1;
  double multiplier = 1;
  double offset = 0;

  double position(std::span<const double> positions) const {
    if (position_index < 0) return 0;
    return multiplier * positions[static_cast<std::size_t>(position_index)] + offset;
  }
};

struct RobotModelOptions {
  std::vector<std::filesystem::path>
      search_paths;       ///< where `package://NAME/…` and relative meshes are looked up
  std::string base_link;  ///< empty: the root link of the URDF
};

/// A robot as its URDF states it: links with surfaces, joints, and where the links are at given positions.
/// Immutable after loading: safe to read from any thread.
class RobotModel {
 public:
  /// Reads a URDF and its meshes. Relative mesh paths and `package://` are looked up in the URDF's folder
  /// first. Errors: RobotModelError (see robot_model_error.hpp), each naming the file, link or joint at
  /// fault.
  static Result<RobotModel> load(const std::filesystem::path& urdf, const RobotModelOptions& options = {});

  const std::string& name() const { return name_; }
  const std::string& base_link() const { return links_[static_cast<std::size_t>(base_link_)].name; }
  const std::vector<Link>& links() const { return links_; }
  const std::vector<Joint>& joints() const { return joints_; }
  /// The links that end the arm, or the arms, as indices.
  std::vector<std::size_t> tip_links() const;
  /// What moves each of joints().
  const std::vector<JointDrive>& drives() const { return drives_; }

  /// Names of the joints that a position vector holds, in its order (depth first from the root, siblings by
  /// joint name).
  const std::vector<std::string>& position_names() const { return position_names_; }
  std::size_t position_count() const { return position_names_.size(); }

  /// T_base_link of every link, in the order of links().
  /// positions: position_count() values, rad or m. Throws std::invalid_argument on any other count.
  std::vector<Pose> forward_kinematics(std::span<const double> positions) const;

  /// The same into `T_base_link` (links().size() poses), without allocating. Throws as forward_kinematics().
  void forward_kinematics_into(std::span<const double> positions, std::span<Pose> T_base_link) const;

  /// Index of the link of that name, or nothing.
  std::optional<int> find_link(std::string_view name) const;

 private:
  friend class RobotModelBuilder;
  std::string name_;
  int base_link_ = 0;
  std::vector<Link> links_;         // parents before children
  std::vector<Joint> joints_;       // parents before children
  std::vector<JointDrive> drives_;  // of joints_
  std::vector<std::string> position_names_;
};

}  // namespace calibrd
