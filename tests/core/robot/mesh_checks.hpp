// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <map>
#include <utility>

#include "core/robot/triangle_mesh.hpp"

namespace calibrd::test {

/// True when every edge is shared by two triangles that run along it in opposite directions.
inline bool is_closed(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int>
      edges;  // forwards minus backwards, by (low, high) vertex
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const auto& triangle : mesh.triangles)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto from = triangle[corner], to = triangle[(corner + 1) % 3];
      const auto edge = std::minmax(from, to);
      edges[edge] += from < to ? 1 : -1;
      uses[edge] += 1;
    }
  for (const auto& [edge, balance] : edges)
    if (balance != 0 || uses[edge] != 2) return false;
  return !mesh.triangles.empty();
}

/// Enclosed volume, m³; positive when normals point outward.
inline double volume(const TriangleMesh& mesh) {
  double six_volumes = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto vertex = [&](std::uint32_t index) {
      return Eigen::Vector3d(mesh.vertices[index].cast<double>());
    };
    six_volumes += vertex(a).dot(vertex(b).cross(vertex(c)));
  }
  return six_volumes / 6;
}

inline Eigen::AlignedBox3f bounds(const TriangleMesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const auto& vertex : mesh.vertices) box.extend(vertex);
  return box;
}

}  // namespace calibrd::test
