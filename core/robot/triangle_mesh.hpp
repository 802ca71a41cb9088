// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

namespace calibrd {

/// A triangle soup. Vertices in metres, in the frame its owner states.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Sum of the triangles' areas, m².
double surface_area(const TriangleMesh& mesh);

/// Appends `part`, its vertices mapped by `T_mesh_part` (which may scale or mirror). A mirroring map turns
/// the triangles round, so that normals keep pointing outward.
void append(TriangleMesh& mesh, const TriangleMesh& part, const Eigen::Affine3d& T_mesh_part);

/// The same surface with equal vertices stored once, and without triangles that fell together.
TriangleMesh weld(const TriangleMesh& mesh);

}  // namespace calibrd
