// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace calibrd::api {

/// A binary little-endian PLY file: float x, y, z (m), and where `residual_m` is not empty (one per point)
/// float residual. `comments`: lines for the header, without line breaks.
std::string write_ply(std::span<const Eigen::Vector3f> points, std::span<const float> residual_m,
                      const std::vector<std::string>& comments);

/// The same with the number of its sensor for every point: uchar sensor. `points_of_sensor`: how many of the
/// points are of sensor 0, then of sensor 1, …
std::string write_merged_ply(std::span<const Eigen::Vector3f> points,
                             std::span<const std::size_t> points_of_sensor,
                             const std::vector<std::string>& comments);

}  // namespace calibrd::api
