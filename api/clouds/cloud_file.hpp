// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace calibrd::api {

/// How points are written; all little-endian.
enum class CloudFormat {
  ply,    ///< binary PLY 1.0
  pcd,    ///< binary PCD 0.7, as PCL reads it
  binary  ///< the points alone, one after the other
};

/// Points, and what is told of each beside its place. At most one of the two is there.
struct CloudData {
  std::span<const Eigen::Vector3f> points;             ///< m
  std::span<const float> residual_m = {};              ///< one per point: a float "residual"
  std::span<const std::size_t> points_of_sensor = {};  ///< how many points are of sensor 0, then of sensor 1,
                                                       ///< …: a byte "sensor"
};

struct CloudFile {
  std::string bytes;
  const char* content_type = "";
  std::string fields;           ///< name and type of each value of a point, in order: "x f4 y f4 z f4"
  std::size_t point_bytes = 0;  ///< of one point
};

/// `comments`: lines for the header of the file, without line breaks; a binary one has none.
CloudFile write_cloud(CloudFormat format, const CloudData& data, const std::vector<std::string>& comments);

/// "ply", "pcd", "binary".
std::optional<CloudFormat> cloud_format(std::string_view name);

}  // namespace calibrd::api
