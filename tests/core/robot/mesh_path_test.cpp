// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/mesh_path.hpp"

#include <gtest/gtest.h>

#include "core/robot/robot_model_error.hpp"
#include "tests/core/robot/scratch_folder.hpp"

namespace calibrd {
namespace {

namespace fs = std::filesystem;

class MeshPath : public ::testing::Test {
 protected:
  fs::path find(const std::string& reference, std::vector<fs::path> search_paths = {}) {
    const auto file = find_mesh(reference, urdf_, search_paths);
    return file ? fs::canonical(*file) : fs::path();
  }

  test::ScratchFolder folder_;
  fs::path urdf_ = folder_.write("x/my_robot/urdf/a.urdf", "");
};

TEST_F(MeshPath, RelativePathStartsAtTheUrdf) {
  const auto mesh = folder_.write("x/my_robot/urdf/meshes/m.stl", "");
  EXPECT_EQ(find("meshes/m.stl"), fs::canonical(mesh));
}

TEST_F(MeshPath, RelativePathIsThenLookedUpInTheSearchPaths) {
  const auto mesh = folder_.write("elsewhere/m.stl", "");
  EXPECT_EQ(find("m.stl", {folder_.path() / "elsewhere"}), fs::canonical(mesh));
}

TEST_F(MeshPath, FileUriIsAnAbsolutePath) {
  const auto mesh = folder_.write("elsewhere/m.stl", "");
  EXPECT_EQ(find("file://" + mesh.string()), fs::canonical(mesh));
}

TEST_F(MeshPath, PackageIsAFolderInASearchPath) {
  const auto mesh = folder_.write("models/other_robot/meshes/m.stl", "");
  EXPECT_EQ(find("package://other_robot/meshes/m.stl", {folder_.path() / "models"}), fs::canonical(mesh));
}

TEST_F(MeshPath, PackageMayBeTheSearchPathItself) {
  const auto mesh = folder_.write("models/other_robot/meshes/m.stl", "");
  EXPECT_EQ(find("package://other_robot/meshes/m.stl", {folder_.path() / "models/other_robot"}),
            fs::canonical(mesh));
  EXPECT_EQ(find("package://other_robot/meshes/m.stl", {folder_.path() / "models/other_robot/"}),
            fs::canonical(mesh));
}

TEST_F(MeshPath, PackageOfTheUrdfIsFoundAboveIt) {
  const auto mesh = folder_.write("x/my_robot/meshes/m.stl", "");
  EXPECT_EQ(find("package://my_robot/meshes/m.stl"), fs::canonical(mesh));
}

TEST_F(MeshPath, SearchPathWinsOverTheFoldersAboveTheUrdf) {
  folder_.write("x/my_robot/meshes/m.stl", "");
  const auto mesh = folder_.write("models/my_robot/meshes/m.stl", "");
  EXPECT_EQ(find("package://my_robot/meshes/m.stl", {folder_.path() / "models"}), fs::canonical(mesh));
}

TEST_F(MeshPath, RelativeUrdfPathIsResolvedAgainstTheCurrentFolder) {
  const auto mesh = folder_.write("x/my_robot/meshes/m.stl", "");
  urdf_ = fs::relative(urdf_);
  EXPECT_EQ(find("package://my_robot/meshes/m.stl"), fs::canonical(mesh));
}

TEST_F(MeshPath, MissingMeshNamesReferenceUrdfAndFolders) {
  const auto file = find_mesh("package://nowhere/m.stl", urdf_, std::vector<fs::path>{"/models"});
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().code, RobotModelError::mesh_not_found);
  for (const auto& culprit : {std::string("package://nowhere/m.stl"), urdf_.string(), std::string("/models")})
    EXPECT_NE(file.error().detail.find(culprit), std::string::npos) << file.error().message();
}

TEST_F(MeshPath, FolderThatIsGivenTwiceIsNamedOnce) {
  const auto folder = urdf_.parent_path();
  const std::vector<fs::path> search_paths{folder, folder / "../urdf"};
  const auto detail = find_mesh("none.stl", urdf_, search_paths).error().detail;
  EXPECT_NE(detail.find("(looked in " + folder.string() + ")"), std::string::npos) << detail;
}

}  // namespace
}  // namespace calibrd
