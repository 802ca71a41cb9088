// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <vector>

namespace calibrd::test {

/// Poses spread over all rotations, the same in every run.
std::vector<Eigen::Isometry3d> random_poses(int count);

/// Where representations of rotations break: no turn, half turns, and the gimbal locks of Rz Ry Rx, Rx Ry Rz
/// and Rz Ry Rz, at them and from 1e-3 to 1e-15 rad beside them.
std::vector<Eigen::Isometry3d> edge_poses();

/// Both.
std::vector<Eigen::Isometry3d> all_poses();

}  // namespace calibrd::test
