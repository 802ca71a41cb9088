// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/meshes/binary_stl.hpp"

#include <bit>
#include <cstdint>

namespace calibrd::api {
namespace {

constexpr std::size_t kHeaderBytes = 80, kTriangleBytes = 50;

void append_number(std::string& bytes, std::uint32_t number) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((number >> shift) & 0xffU);
}

void append_vector(std::string& bytes, const Eigen::Vector3f& vector) {
  for (const float value : vector) append_number(bytes, std::bit_cast<std::uint32_t>(value));
}

}  // namespace

std::string binary_stl(const TriangleMesh& mesh) {
  std::string bytes = "calibrd, link frame, m";
  bytes.reserve(kHeaderBytes + 4 + kTriangleBytes * mesh.triangles.size());
  bytes.resize(kHeaderBytes, ' ');
  append_number(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3f &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    append_vector(bytes, (q - p).cross(r - p).stableNormalized());
    for (const auto* corner : {&p, &q, &r}) append_vector(bytes, *corner);
    bytes.append(2, '\0');  // the attribute, which nobody uses
  }
  return bytes;
}

}  // namespace calibrd::api
