// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/triangle_mesh.hpp"

#include <bit>
#include <unordered_map>
#include <utility>

namespace calibrd {
namespace {

using VertexBits = std::array<std::uint32_t, 3>;

struct VertexBitsHash {
  std::size_t operator()(const VertexBits& bits) const {
    std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a over words
    for (const std::uint32_t word : bits) hash = (hash ^ word) * 0x100000001b3;
    return static_cast<std::size_t>(hash ^ (hash >> 32));
  }
};

VertexBits bits_of(const Eigen::Vector3f& vertex) {
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value + 0.0F); };  // -0 equals 0
  return {bits(vertex.x()), bits(vertex.y()), bits(vertex.z())};
}

}  // namespace

double surface_area(const TriangleMesh& mesh) {
  double twice_area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d corner = mesh.vertices[a].cast<double>();
    const Eigen::Vector3d side = mesh.vertices[b].cast<double>() - corner;
    twice_area += side.cross(mesh.vertices[c].cast<double>() - corner).norm();
  }
  return twice_area / 2;
}

void append(TriangleMesh& mesh, const TriangleMesh& part, const Eigen::Affine3d& T_mesh_part) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const bool mirrored = T_mesh_part.linear().determinant() < 0;
  mesh.vertices.reserve(mesh.vertices.size() + part.vertices.size());
  for (const auto& vertex : part.vertices)
    mesh.vertices.emplace_back((T_mesh_part * vertex.cast<double>()).cast<float>());
  mesh.triangles.reserve(mesh.triangles.size() + part.triangles.size());
  for (auto [a, b, c] : part.triangles) {
    if (mirrored) std::swap(b, c);
    mesh.triangles.push_back({first + a, first + b, first + c});
  }
}

TriangleMesh weld(const TriangleMesh& mesh) {
  TriangleMesh welded;
  std::unordered_map<VertexBits, std::uint32_t, VertexBitsHash> known;
  std::vector<std::uint32_t> renamed;
  renamed.reserve(mesh.vertices.size());
  for (const auto& vertex : mesh.vertices) {
    const auto next = static_cast<std::uint32_t>(welded.vertices.size());
    const auto [entry, is_new] = known.try_emplace(bits_of(vertex), next);
    if (is_new) welded.vertices.push_back(vertex);
    renamed.push_back(entry->second);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::array triangle{renamed[a], renamed[b], renamed[c]};
    if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
      welded.triangles.push_back(triangle);
  }
  return welded;
}

}  // namespace calibrd
