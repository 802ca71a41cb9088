// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/recording/tar.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "server/recording/pack_robot.hpp"

namespace calibrd {
namespace {

namespace fs = std::filesystem;

class Recording : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("calibrd_tar_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  static void write(const fs::path& file, const std::string& text) {
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
  }
  static std::string read(const fs::path& file) {
    std::stringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }
  bool unpack(const std::string& tar) {
    write(folder_ / "a.tar", tar);
    fs::create_directories(folder_ / "out");
    const auto command = "tar -C " + (folder_ / "out").string() + " -xf " + (folder_ / "a.tar").string();
    return std::system(command.c_str()) == 0;
  }
  fs::path folder_;
};

TEST_F(Recording, ArchiveIsUnpackedByTheSystemsTar) {
  const std::string deep = std::string(60, 'd') + "/" + std::string(90, 'f');
  write(folder_ / "in/a.txt", "text");
  write(folder_ / "in/empty", "");
  write(folder_ / "in" / deep, std::string(100'000, '\xff'));
  const auto tar = tar_of_folder(folder_ / "in", "top");
  ASSERT_TRUE(tar) << tar.error().message();
  ASSERT_TRUE(unpack(*tar));
  EXPECT_EQ(read(folder_ / "out/top/a.txt"), "text");
  EXPECT_TRUE(fs::exists(folder_ / "out/top/empty"));
  EXPECT_EQ(read(folder_ / "out/top" / deep), std::string(100'000, '\xff'));
}

TEST_F(Recording, NameTooLongForTheFormatIsAnError) {
  TarWriter tar;
  EXPECT_FALSE(tar.add_file(std::string(101, 'n'), "x", 0));
  EXPECT_FALSE(tar.add_file("", "x", 0));
  EXPECT_TRUE(tar.add_file(std::string(100, 'n'), "x", 0));
}

TEST_F(Recording, AbsentFolderIsAnError) { EXPECT_FALSE(tar_of_folder(folder_ / "none", "top")); }

TEST_F(Recording, RobotIsPackedWithItsMeshesWhereAReaderLooksForThem) {
  write(folder_ / "models/arm/meshes/a.stl", "a");
  write(folder_ / "model/b.stl", "b");
  write(folder_ / "model/arm.urdf",
        "<mesh filename=\"package://arm/meshes/a.stl\"/><mesh scale='1 1 1' filename='b.stl'/>");
  const std::vector<fs::path> search{folder_ / "models"};
  const auto packed = pack_robot(folder_ / "model/arm.urdf", search, folder_ / "out");
  ASSERT_TRUE(packed) << packed.error().message();
  EXPECT_EQ(read(folder_ / "out/arm/meshes/a.stl"), "a");
  EXPECT_EQ(read(folder_ / "out/b.stl"), "b");
  EXPECT_EQ(read(folder_ / "out/robot.urdf"), read(folder_ / "model/arm.urdf"));
}

TEST_F(Recording, MeshOutsideTheUrdfsFolderIsNotWrittenOutsideTheCapture) {
  write(folder_ / "b.stl", "b");
  write(folder_ / "model/arm.urdf", "<mesh filename=\"../b.stl\"/>");
  ASSERT_TRUE(pack_robot(folder_ / "model/arm.urdf", {}, folder_ / "out/capture"));
  EXPECT_FALSE(fs::exists(folder_ / "out/b.stl"));
}

TEST_F(Recording, MissingMeshIsNamed) {
  write(folder_ / "model/arm.urdf", "<mesh filename=\"none.stl\"/>");
  const auto packed = pack_robot(folder_ / "model/arm.urdf", {}, folder_ / "out");
  ASSERT_FALSE(packed);
  EXPECT_NE(packed.error().message().find("none.stl"), std::string::npos);
}

}  // namespace
}  // namespace calibrd
