// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "core/base/result.hpp"
#include "core/robot/robot_model.hpp"

namespace urdf {
class Link;
}

namespace calibrd {

/// The surface of a link, link frame, m: all its <visual> shapes, or its <collision> shapes when it has no
/// <visual>; empty when it has neither. Errors: RobotModelError::mesh_not_found, mesh_unreadable,
/// bad_geometry, bad_number; each names link and file.
Result<TriangleMesh> read_link_surface(const urdf::Link& link, const std::filesystem::path& urdf,
                                       const RobotModelOptions& options);

}  // namespace calibrd
