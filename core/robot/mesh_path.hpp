// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "core/base/result.hpp"

namespace calibrd {

/// The file a URDF means by `reference`: a path, `file://…` or `package://NAME/…`.
///
/// Relative paths are looked up in the URDF's folder, then in the search paths. `package://NAME/rel` is
/// looked up as DIR/NAME/rel, and as DIR/rel where DIR itself is called NAME; DIR is the URDF's folder, each
/// search path, then each folder above the URDF. Error: RobotModelError::mesh_not_found, its detail names the
/// reference, the URDF and the folders tried.
Result<std::filesystem::path> find_mesh(const std::string& reference, const std::filesystem::path& urdf,
                                        std::span<const std::filesystem::path> search_paths);

}  // namespace calibrd
