// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>

#include "core/sensing/images.hpp"
#include "core/virtual_cell/virtual_cell.hpp"

/// Which pixels of a single frame can be held against its prediction.
namespace calibrd {

/// What the pixel measures; 0 when nothing, two surfaces at once, or it lies at the border of the image.
double measured_m(const DepthImage& depth, int x, int y);

/// The pixel, which must see the robot, is the robot's edge: the tangent plane there does not run on to its
/// neighbours. `rays`: of the prediction's pixels, z = 1.
bool is_rim(const VirtualMeasurement& prediction, std::span<const Eigen::Vector3d> rays, int x, int y);

}  // namespace calibrd
