// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace calibrd {

/// `count` rotations spread evenly over all rotations: super-Fibonacci spirals (Alexa, CVPR 2022). 600 of
/// them lie about 27° apart.
std::vector<Eigen::Matrix3d> even_rotations(std::size_t count);

}  // namespace calibrd
