// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "core/robot/triangle_mesh.hpp"

namespace calibrd::demo {

/// Writes `mesh_mm` as binary STL in metres. False when the file cannot be written.
bool write_stl(const std::filesystem::path& file, const TriangleMesh& mesh_mm);

}  // namespace calibrd::demo
