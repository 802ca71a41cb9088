// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "config/demo_robot/stl.hpp"

#include <Eigen/Geometry>
#include <bit>
#include <cstdint>
#include <fstream>
#include <string>

namespace calibrd::demo {
namespace {

constexpr std::size_t kHeaderSize = 80;
constexpr float kMetresPerMillimetre = 0.001F;

void put_little_endian(std::string& bytes, std::uint32_t value, int count) {
  for (int byte = 0; byte < count; ++byte) bytes.push_back(static_cast<char>((value >> (8 * byte)) & 0xFF));
}

void put(std::string& bytes, const Eigen::Vector3f& vector) {
  for (const float value : vector) put_little_endian(bytes, std::bit_cast<std::uint32_t>(value), 4);
}

}  // namespace

bool write_stl(const std::filesystem::path& file, const TriangleMesh& mesh_mm) {
  std::string bytes = "calibrd demo robot, metres";
  bytes.resize(kHeaderSize, ' ');
  put_little_endian(bytes, static_cast<std::uint32_t>(mesh_mm.triangles.size()), 4);
  for (const auto& [a, b, c] : mesh_mm.triangles) {
    const Eigen::Vector3f corners[] = {mesh_mm.vertices[a], mesh_mm.vertices[b], mesh_mm.vertices[c]};
    put(bytes, (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized());
    for (const auto& corner : corners) put(bytes, corner * kMetresPerMillimetre);
    put_little_endian(bytes, 0, 2);  // attribute byte count
  }
  std::ofstream stream(file, std::ios::binary);
  stream << bytes;
  return static_cast<bool>(stream.flush());
}

}  // namespace calibrd::demo
