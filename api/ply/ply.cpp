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

void append_point(std::string& bytes, const Eigen::Vector3f& point) {
  for (const float value : point) append_float(bytes, value);
}

std::string header(std::size_t points, const std::vector<std::string>& comments, const char* property) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  for (const auto& comment : comments) text += "comment " + comment + "\n";
  text += "element vertex " + std::to_string(points) + "\n";
  text += "property float x\nproperty float y\nproperty float z\n";
  return text + property + "end_header\n";
}

}  // namespace

std::string write_ply(std::span<const Eigen::Vector3f> points, std::span<const float> residual_m,
                      const std::vector<std::string>& comments) {
  auto file = header(points.size(), comments, residual_m.empty() ? "" : "property float residual\n");
  file.reserve(file.size() + points.size() * (residual_m.empty() ? 12 : 16));
  for (std::size_t i = 0; i < points.size(); ++i) {
    append_point(file, points[i]);
    if (!residual_m.empty()) append_float(file, residual_m[i]);
  }
  return file;
}

std::string write_merged_ply(std::span<const Eigen::Vector3f> points,
                             std::span<const std::size_t> points_of_sensor,
                             const std::vector<std::string>& comments) {
  auto file = header(points.size(), comments, "property uchar sensor\n");
  file.reserve(file.size() + points.size() * 13);
  std::size_t next = 0;
  for (std::size_t sensor = 0; sensor < points_of_sensor.size(); ++sensor)
    for (std::size_t i = 0; i < points_of_sensor[sensor]; ++i) {
      append_point(file, points[next++]);
      file += static_cast<char>(sensor);
    }
  return file;
}

}  // namespace calibrd::api
