// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/mesh_file.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <span>

#include "core/robot/robot_model_error.hpp"

namespace calibrd {
namespace {

Eigen::Affine3d to_eigen(const aiMatrix4x4& matrix) {
  Eigen::Affine3d affine;
  for (unsigned row = 0; row < 3; ++row)
    for (unsigned column = 0; column < 4; ++column) affine(row, column) = matrix[row][column];
  affine.makeAffine();
  return affine;
}

TriangleMesh to_mesh(const aiMesh& part) {
  TriangleMesh mesh;
  mesh.vertices.reserve(part.mNumVertices);
  for (const aiVector3D& vertex : std::span(part.mVertices, part.mNumVertices))
    mesh.vertices.emplace_back(vertex.x, vertex.y, vertex.z);
  for (const aiFace& face : std::span(part.mFaces, part.mNumFaces))
    if (face.mNumIndices == 3)
      mesh.triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
  return mesh;
}

void append_node(TriangleMesh& mesh, const aiScene& scene, const aiNode& node,
                 const Eigen::Affine3d& T_file_parent) {
  const Eigen::Affine3d T_file_node = T_file_parent * to_eigen(node.mTransformation);
  for (const unsigned part : std::span(node.mMeshes, node.mNumMeshes))
    append(mesh, to_mesh(*scene.mMeshes[part]), T_file_node);
  for (const aiNode* child : std::span(node.mChildren, node.mNumChildren))
    append_node(mesh, scene, *child, T_file_node);
}

Error unreadable(const std::filesystem::path& file, const std::string& reason) {
  return {RobotModelError::mesh_unreadable, file.string() + " (" + reason + ")"};
}

}  // namespace

Result<TriangleMesh> read_mesh_file(const std::filesystem::path& file) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_SortByPType);
  if (scene == nullptr || scene->mRootNode == nullptr) return unreadable(file, importer.GetErrorString());

  TriangleMesh mesh;
  append_node(mesh, *scene, *scene->mRootNode, Eigen::Affine3d::Identity());
  mesh = weld(mesh);
  if (mesh.triangles.empty()) return unreadable(file, "it holds no triangle");
  if (!std::ranges::all_of(mesh.vertices, [](const auto& vertex) { return vertex.allFinite(); }))
    return unreadable(file, "a vertex is not a finite number");
  return mesh;
}

}  // namespace calibrd
