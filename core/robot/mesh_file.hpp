// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "core/base/result.hpp"
#include "core/robot/triangle_mesh.hpp"

namespace calibrd {

/// Reads a mesh file (.stl, .dae for Collada, .obj), as the robotics world does: numbers are
/// metres unless a Collada file states another unit, which is applied; a Collada file's up-axis is ignored.
/// Error: RobotModelError::mesh_unreadable, its detail names the file and what is wrong with it.
Result<TriangleMesh> read_mesh_file(const std::filesystem::path& file);

}  // namespace calibrd
