// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "core/base/result.hpp"

namespace calibrd {

/// Copies a URDF to FOLDER/robot.urdf and its meshes to where a reader of FOLDER finds them: NAME/rest for
/// package://NAME/rest, the same relative path for a relative one. Meshes with absolute paths stay where they
/// are. Errors: RobotModelError::mesh_not_found, or std::errc of the file system.
Status pack_robot(const std::filesystem::path& urdf, std::span<const std::filesystem::path> search_paths,
                  const std::filesystem::path& folder);

}  // namespace calibrd
