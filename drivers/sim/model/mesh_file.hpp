// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <filesystem>

#include "core/base/result.hpp"
#include "drivers/sim/world/mesh.hpp"

namespace calibrd::sim {

/// Reads a mesh: binary STL by itself, anything else (Collada, OBJ, ASCII STL) by Assimp. `scale` multiplies
/// the coordinates. Collada's unit is honoured, its up-axis ignored, as the robotics world does. Errors:
/// mesh_unreadable.
Result<Mesh> read_mesh(const std::filesystem::path& path, const Eigen::Vector3d& scale);

}  // namespace calibrd::sim
