// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/ply/ply.hpp"

#include <bit>
#include <cstdint>

namespace calibrd::api {
namespace {

void append_float(std::string& bytes, float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((bits >> shift) & 0xffU);
}

}  // namespace

std::string write_ply(std::span<const Eigen::Vector3f> points, std::span<const float> residual_m,
                      const std::vector<std::string>& comments) {
  std::string file = "ply\nformat binary_little_endian 1.0\n";
  for (const auto& comment : comments) file += "comment " + comment + "\n";
  file += "element vertex " + std::to_string(points.size()) + "\n";
  file += "property float x\nproperty float y\nproperty float z\n";
  if (!residual_m.empty()) file += "property float residual\n";
  file += "end_header\n";
  file.reserve(file.size() + points.size() * (residual_m.empty() ? 12 : 16));
  for (std::size_t i = 0; i < points.size(); ++i) {
    append_float(file, points[i].x());
    append_float(file, points[i].y());
    append_float(file, points[i].z());
    if (!residual_m.empty()) append_float(file, residual_m[i]);
  }
  return file;
}

}  // namespace calibrd::api
