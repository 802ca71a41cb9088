// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/model/mesh_file.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <bit>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include "drivers/sim/world/sim_error.hpp"

namespace calibrd::sim {
namespace {

constexpr std::size_t kStlHeader = 80, kStlFacet = 50;

std::uint32_t little_u32(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return value;
}

/// Nothing when the bytes are no binary STL (their length gives it away).
std::optional<Mesh> binary_stl(const std::string& bytes) {
  if (bytes.size() < kStlHeader + 4) return std::nullopt;
  const std::size_t facets = little_u32(bytes, kStlHeader);
  if (bytes.size() != kStlHeader + 4 + facets * kStlFacet) return std::nullopt;
  Mesh mesh;
  for (std::size_t f = 0; f < facets; ++f) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::size_t v = 0; v < 3; ++v) {
      const std::size_t at = kStlHeader + 4 + f * kStlFacet + 12 * (v + 1);  // after the facet's normal
      mesh.vertices.emplace_back(std::bit_cast<float>(little_u32(bytes, at)),
                                 std::bit_cast<float>(little_u32(bytes, at + 4)),
                                 std::bit_cast<float>(little_u32(bytes, at + 8)));
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

void append_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, Mesh& mesh) {
  const aiMatrix4x4 T_file_node = above * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& source = *scene.mMeshes[node.mMeshes[i]];
    Mesh part;
    for (unsigned v = 0; v < source.mNumVertices; ++v) {
      const aiVector3D p = T_file_node * source.mVertices[v];
      part.vertices.emplace_back(p.x, p.y, p.z);
    }
    for (unsigned f = 0; f < source.mNumFaces; ++f)
      if (const aiFace& face = source.mFaces[f]; face.mNumIndices == 3)
        part.triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
    append(mesh, part);
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) append_node(scene, *node.mChildren[i], T_file_node, mesh);
}

Mesh by_assimp(const std::filesystem::path& path) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(path.string(), aiProcess_Triangulate | aiProcess_JoinIdenticalVertices);
  Mesh mesh;
  if (scene != nullptr && scene->mRootNode != nullptr) append_node(*scene, *scene->mRootNode, {}, mesh);
  return mesh;
}

}  // namespace

Result<Mesh> read_mesh(const std::filesystem::path& path, const Eigen::Vector3d& scale) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  Mesh mesh;
  if (auto stl = binary_stl(bytes))
    mesh = std::move(*stl);
  else
    mesh = by_assimp(path);
  if (mesh.triangles.empty()) return sim_error(SimError::mesh_unreadable, path.string());
  for (auto& vertex : mesh.vertices) vertex = vertex.cwiseProduct(scale.cast<float>());
  mesh.solid = is_solid(mesh);
  return mesh;
}

}  // namespace calibrd::sim
