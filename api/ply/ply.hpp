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

}  // namespace calibrd::api
