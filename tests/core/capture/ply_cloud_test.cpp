// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/capture/ply_cloud.hpp"

#include <gtest/gtest.h>

#include "core/capture/capture_error.hpp"
#include "tests/core/robot/scratch_folder.hpp"

namespace calibrd {
namespace {

using test::ScratchFolder;

// 1, -2 and 0.5 as a PLY file holds them.
const std::string kOne("\x00\x00\x80\x3f", 4), kMinusTwo("\x00\x00\x00\xc0", 4), kHalf("\x00\x00\x00\x3f", 4);
const std::string kPoint = kOne + kMinusTwo + kHalf;

std::string header(const std::string& format, const std::string& rest) {
  return "ply\nformat " + format + " 1.0\ncomment a cloud\n" + rest + "end_header\n";
}
std::string xyz(const std::string& type, int count) {
  return "element vertex " + std::to_string(count) + "\nproperty " + type + " x\nproperty " + type +
         " y\nproperty " + type + " z\n";
}

Result<std::vector<Eigen::Vector3f>> read(const std::string& bytes) {
  const ScratchFolder folder;
  return read_ply(folder.write("cloud.ply", bytes));
}

void expect_error(const std::string& bytes, std::error_code code, const std::string& advice) {
  const auto points = read(bytes);
  ASSERT_FALSE(points);
  EXPECT_EQ(points.error().code, code) << points.error().message();
  EXPECT_NE(points.error().message().find(advice), std::string::npos) << points.error().message();
  EXPECT_NE(points.error().message().find("cloud.ply"), std::string::npos) << "the file is not named";
}

TEST(PlyCloud, FloatsAreReadInOrder) {
  const auto points = read(header("binary_little_endian", xyz("float", 2)) + kPoint + kHalf + kOne + kOne);
  ASSERT_TRUE(points) << points.error().message();
  ASSERT_EQ(points->size(), 2U);
  EXPECT_EQ((*points)[0], Eigen::Vector3f(1, -2, 0.5F));
  EXPECT_EQ((*points)[1], Eigen::Vector3f(0.5F, 1, 1));
}

TEST(PlyCloud, OtherPropertiesAndElementsAreLeftAside) {
  const std::string layout =
      "element vertex 1\nproperty uchar red\nproperty float32 z\nproperty float32 x\nproperty double time\n"
      "property float32 y\nelement face 1\nproperty list uchar int vertex_indices\n";
  const auto points =
      read(header("binary_little_endian", layout) + "R" + kHalf + kOne + "12345678" + kMinusTwo);
  ASSERT_TRUE(points) << points.error().message();
  EXPECT_EQ((*points)[0], Eigen::Vector3f(1, -2, 0.5F));
}

TEST(PlyCloud, AnEmptyCloudIsACloud) {
  const auto points = read(header("binary_little_endian", xyz("float", 0)));
  ASSERT_TRUE(points) << points.error().message();
  EXPECT_TRUE(points->empty());
}

TEST(PlyCloud, MissingFileIsNamed) {
  const auto points = read_ply("/nowhere/cloud.ply");
  ASSERT_FALSE(points);
  EXPECT_EQ(points.error().code, make_error_code(CaptureError::unreadable));
  EXPECT_NE(points.error().message().find("/nowhere/cloud.ply"), std::string::npos);
}

TEST(PlyCloud, AsciiAndBigEndianAreToldHowToExport) {
  expect_error(header("ascii", xyz("float", 1)) + "1 -2 0.5\n", PlyError::not_binary_little_endian, "export");
  expect_error(header("binary_big_endian", xyz("float", 1)) + kPoint, PlyError::not_binary_little_endian,
               "little-endian");
}

TEST(PlyCloud, TruncatedFileSaysHowManyPointsThereAre) {
  const std::string file = header("binary_little_endian", xyz("float", 3)) + kPoint + kPoint + kOne;
  expect_error(file, PlyError::truncated, "2 of 3 points");
  expect_error(header("binary_little_endian", xyz("float", 3)).substr(0, 40), PlyError::bad_header,
               "export the cloud again");
}

TEST(PlyCloud, ACountThatOverflowsIsNotTrusted) {
  const std::string layout = "element vertex 18446744073709551615\nproperty float x\nproperty float y\n";
  expect_error(header("binary_little_endian", layout + "property float z\n") + kPoint, PlyError::truncated,
               "1 of 18446744073709551615");
  expect_error(header("binary_little_endian", "element vertex -1\nproperty float x\n"), PlyError::bad_header,
               "element vertex -1");
}

TEST(PlyCloud, WrongPropertiesAreNamed) {
  expect_error(header("binary_little_endian", xyz("double", 1)) + kPoint + kPoint, PlyError::wrong_properties,
               "property double x");
  expect_error(
      header("binary_little_endian", "element vertex 1\nproperty float x\nproperty float y\n") + kPoint,
      PlyError::wrong_properties, "missing");
  const std::string list = "element vertex 1\nproperty list uchar float x\n";
  expect_error(header("binary_little_endian", list) + kPoint, PlyError::wrong_properties, "no list");
}

TEST(PlyCloud, FacesInFrontAreNoVertices) {
  expect_error(
      header("binary_little_endian", "element face 1\nproperty list uchar int i\n" + xyz("float", 1)),
      PlyError::no_vertices, "vertices");
}

TEST(PlyCloud, OtherFilesAreNoPly) {
  expect_error("solid stl\n", PlyError::not_ply, "PLY");
  expect_error("", PlyError::not_ply, "PLY");
}

}  // namespace
}  // namespace calibrd
