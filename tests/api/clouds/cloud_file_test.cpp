// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/clouds/cloud_file.hpp"

#include <gtest/gtest.h>

#include <cstring>

namespace calibrd::api {
namespace {

const std::vector<Eigen::Vector3f> kPoints{{1, 2, 3}, {-4, 5.5F, 6}, {7, 8, 9}};

float float_at(const std::string& bytes, std::size_t at) {
  float value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST(CloudFile, BinaryIsThePointsAlone) {
  const auto file = write_cloud(CloudFormat::binary, {kPoints}, {"not to be seen"});
  EXPECT_EQ(file.bytes.size(), 36U);
  EXPECT_EQ(float_at(file.bytes, 16), 5.5F);
  EXPECT_EQ(file.point_bytes, 12U);
  EXPECT_EQ(file.fields, "x f4 y f4 z f4");
  EXPECT_STREQ(file.content_type, "application/octet-stream");
}

TEST(CloudFile, BytesAreLittleEndian) {
  const std::vector<Eigen::Vector3f> one{{1, 0, 0}};  // 0x3f800000
  EXPECT_EQ(write_cloud(CloudFormat::binary, {one}, {}).bytes.substr(0, 4), std::string("\0\0\x80\x3f", 4));
}

TEST(CloudFile, PcdSaysWhatItHolds) {
  const std::vector<float> residual{0.5F, 0.25F, -1};
  const auto file = write_cloud(CloudFormat::pcd, {kPoints, residual}, {"Calibrd-Frame base"});
  const std::string head =
      "# .PCD v0.7 - Point Cloud Data file format\n# Calibrd-Frame base\nVERSION 0.7\nFIELDS x y z residual\n"
      "SIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA "
      "binary\n";
  ASSERT_EQ(file.bytes.substr(0, head.size()), head);
  EXPECT_EQ(file.bytes.size(), head.size() + 48);
  EXPECT_EQ(float_at(file.bytes, head.size() + 28), 0.25F);
  EXPECT_EQ(file.fields, "x f4 y f4 z f4 residual f4");
  EXPECT_STREQ(file.content_type, "application/x-pcd");
}

TEST(CloudFile, PlyNumbersTheSensors) {
  const std::vector<std::size_t> of_sensor{1, 0, 2};
  const auto file = write_cloud(CloudFormat::ply, {kPoints, {}, of_sensor}, {"made here"});
  const std::string head =
      "ply\nformat binary_little_endian 1.0\ncomment made here\nelement vertex 3\nproperty float x\nproperty "
      "float y\n"
      "property float z\nproperty uchar sensor\nend_header\n";
  ASSERT_EQ(file.bytes.substr(0, head.size()), head);
  ASSERT_EQ(file.bytes.size(), head.size() + 39);
  EXPECT_EQ(file.bytes[head.size() + 12], 0);
  EXPECT_EQ(file.bytes[head.size() + 25], 2) << "sensor 1 has no point";
  EXPECT_EQ(file.bytes[head.size() + 38], 2);
}

TEST(CloudFile, NamesOfFormats) {
  EXPECT_EQ(cloud_format("pcd"), CloudFormat::pcd);
  EXPECT_FALSE(cloud_format("xyz"));
}

}  // namespace
}  // namespace calibrd::api
