// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/mesh_file.hpp"

#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>

#include "core/robot/collada_nodes.hpp"
#include "core/robot/robot_model_error.hpp"
#include "core/robot/xml_tags.hpp"

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

/// The kinds of files that robot models use, by their endings. Assimp knows some fifty more and chooses by
/// what a file holds, whatever its name: readers that nobody here has tested, for files that nobody means.
constexpr std::array<std::string_view, 3> kKinds{"stl", "dae", "obj"};
constexpr std::size_t kMaxColladaDepth = 128;

std::string kind_of(const std::filesystem::path& file) {
  std::string kind = file.extension().string();
  std::ranges::transform(kind, kind.begin(), [](unsigned char c) { return std::tolower(c); });
  return kind.empty() ? kind : kind.substr(1);
}

/// Leaves the importer with the one reader that the file's name asks for.
void keep_only(Assimp::Importer& importer, const std::string& kind) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    std::istringstream endings(importer.GetImporterInfo(i)->mFileExtensions);
    const std::istream_iterator<std::string> first(endings), none;
    if (std::find(first, none, kind) != none) continue;
    const std::unique_ptr<Assimp::BaseImporter> reader(importer.GetImporter(i));
    importer.UnregisterLoader(reader.get());  // which does not delete it
  }
}

/// Why the text is not given to assimp's reader of Collada.
std::optional<std::string> refusal_of_collada(std::string_view text) {
  constexpr std::string_view kZipEnd = "PK\5\6";  // assimp would look into the archive
  if (text.find('\0') != std::string_view::npos || text.find(kZipEnd) != std::string_view::npos)
    return "it is no XML in UTF-8";
  if (xml_depth(text) > kMaxColladaDepth)
    return "elements more than " + std::to_string(kMaxColladaDepth) + " deep";
  if (!nodes_come_to_an_end(text))
    return "its nodes instance each other without end, or its names hold entities";
  return std::nullopt;
}

/// Why the file is not given to assimp.
std::optional<std::string> refusal(const std::filesystem::path& file, const std::string& kind) {
  if (std::ranges::find(kKinds, kind) == kKinds.end()) return "it is no .stl, .dae or .obj";
  if (kind != "dae") return std::nullopt;
  std::ifstream stream(file, std::ios::binary);
  return refusal_of_collada(std::string(std::istreambuf_iterator<char>(stream), {}));
}

}  // namespace

Result<TriangleMesh> read_mesh_file(const std::filesystem::path& file) {
  const std::string kind = kind_of(file);
  if (const auto why = refusal(file, kind)) return unreadable(file, *why);
  Assimp::Importer importer;
  keep_only(importer, kind);
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
