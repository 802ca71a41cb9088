// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "core/robot/robot_model.hpp"
#include "core/robot/robot_model_error.hpp"

namespace urdf {
class Joint;
class Link;
class ModelInterface;
}  // namespace urdf

namespace calibrd {

/// Turns what urdfdom read into a RobotModel, or says what is wrong with it.
class RobotModelBuilder {
 public:
  RobotModelBuilder(const urdf::ModelInterface& source, const std::filesystem::path& urdf,
                    const RobotModelOptions& options)
      : source_(source), urdf_(urdf), options_(options) {}

  Result<RobotModel> build();

 private:
  Status add_branch(const urdf::Link& link, int parent_joint);
  Status add_joint(const urdf::Joint& joint, int parent_link);
  Status check_tree() const;
  Status link_mimics();
  Status set_drives();
  Result<JointDrive> drive_of(std::size_t joint) const;
  Status choose_base();
  Status read_surfaces();

  Error at_joint(RobotModelError code, const std::string& joint, const std::string& what = {}) const;

  const urdf::ModelInterface& source_;
  const std::filesystem::path& urdf_;
  const RobotModelOptions& options_;
  RobotModel model_;
};

}  // namespace calibrd
