// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/clouds/cloud_file.hpp"

#include <bit>
#include <cstdint>

namespace calibrd::api {
namespace {

/// One value of every point.
struct Field {
  const char* name;
  bool is_float;  ///< 4 bytes; else one unsigned byte
};

std::vector<Field> fields_of(const CloudData& data) {
  std::vector<Field> fields{{"x", true}, {"y", true}, {"z", true}};
  if (!data.residual_m.empty()) fields.push_back({"residual", true});
  if (!data.points_of_sensor.empty()) fields.push_back({"sensor", false});
  return fields;
}

std::size_t point_bytes(const std::vector<Field>& fields) {
  std::size_t bytes = 0;
  for (const auto& field : fields) bytes += field.is_float ? 4 : 1;
  return bytes;
}

std::string ply_header(std::size_t points, const std::vector<Field>& fields,
                       const std::vector<std::string>& comments) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  for (const auto& comment : comments) text += "comment " + comment + "\n";
  text += "element vertex " + std::to_string(points) + "\n";
  for (const auto& field : fields)
    text.append("property ").append(field.is_float ? "float " : "uchar ").append(field.name).append("\n");
  return text + "end_header\n";
}

/// https://pointclouds.org/documentation/tutorials/pcd_file_format.html
std::string pcd_header(std::size_t points, const std::vector<Field>& fields,
                       const std::vector<std::string>& comments) {
  std::string text = "# .PCD v0.7 - Point Cloud Data file format\n";
  for (const auto& comment : comments) text += "# " + comment + "\n";
  std::string names = "FIELDS", sizes = "SIZE", types = "TYPE", counts = "COUNT";
  for (const auto& field : fields) {
    names.append(" ").append(field.name);
    sizes += field.is_float ? " 4" : " 1";
    types += field.is_float ? " F" : " U";
    counts += " 1";
  }
  const auto number = std::to_string(points);
  return text + "VERSION 0.7\n" + names + "\n" + sizes + "\n" + types + "\n" + counts + "\nWIDTH " + number +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + number + "\nDATA binary\n";
}

void append_float(std::string& bytes, float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((bits >> shift) & 0xffU);
}

void append_points(std::string& bytes, const CloudData& data) {
  std::size_t sensor = 0, left = data.points_of_sensor.empty() ? 0 : data.points_of_sensor[0];
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    for (const float value : data.points[i]) append_float(bytes, value);
    if (!data.residual_m.empty()) append_float(bytes, data.residual_m[i]);
    if (data.points_of_sensor.empty()) continue;
    while (left == 0 && sensor + 1 < data.points_of_sensor.size()) left = data.points_of_sensor[++sensor];
    bytes += static_cast<char>(sensor);
    --left;
  }
}

}  // namespace

CloudFile write_cloud(CloudFormat format, const CloudData& data, const std::vector<std::string>& comments) {
  const auto fields = fields_of(data);
  CloudFile file{{}, "application/octet-stream", {}, point_bytes(fields)};
  if (format == CloudFormat::ply) {
    file.bytes = ply_header(data.points.size(), fields, comments);
    file.content_type = "application/x-ply";
  } else if (format == CloudFormat::pcd) {
    file.bytes = pcd_header(data.points.size(), fields, comments);
    file.content_type = "application/x-pcd";
  }
  for (const auto& field : fields)
    file.fields.append(file.fields.empty() ? "" : " ")
        .append(field.name)
        .append(field.is_float ? " f4" : " u1");
  file.bytes.reserve(file.bytes.size() + data.points.size() * file.point_bytes);
  append_points(file.bytes, data);
  return file;
}

std::optional<CloudFormat> cloud_format(std::string_view name) {
  if (name == "ply") return CloudFormat::ply;
  if (name == "pcd") return CloudFormat::pcd;
  if (name == "binary") return CloudFormat::binary;
  return std::nullopt;
}

}  // namespace calibrd::api
