// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/sim/world/robot.hpp"

namespace calibrd::sim {

struct RobotFileOptions {
  std::vector<std::filesystem::path>
      models;             ///< folders to look `package://NAME/...` and relative meshes up in
  std::string base_link;  ///< empty: the URDF's root
};

/// Reads a URDF and its meshes (visual ones, collision ones where there are none). Meshes are looked up in
/// the URDF's folder, in each folder above it, then in `models`. Errors: urdf_unreadable, mesh_not_found,
/// mesh_unreadable, no_joints, too_large.
Result<Robot> read_robot(const std::filesystem::path& urdf, const RobotFileOptions& options);

}  // namespace calibrd::sim
