// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

namespace calibrd::api {

/// Three angles in the order of the product, rad, in (-pi, pi]; the middle one is in [-pi/2, pi/2], that of
/// Rz Ry Rz in [0, pi].
///
/// At the gimbal lock (the cosine of the middle angle, of Rz Ry Rz its sine, is below 1e-10) only a sum or a
/// difference of the other two is defined: the third is 0. Near it the two follow the noise of the rotation,
/// but the third is always taken from what the first leaves over, so that their product is the rotation to
/// rounding.
struct EulerAngles {
  double first = 0, second = 0, third = 0;
};

/// R = Rz(first) Ry(second) Rx(third): about z, the new y, the newest x; or about fixed x, y, z.
EulerAngles zyx_angles(const Eigen::Matrix3d& rotation);
/// R = Rx(first) Ry(second) Rz(third): about x, the new y, the newest z; or about fixed z, y, x.
EulerAngles xyz_angles(const Eigen::Matrix3d& rotation);
/// R = Rz(first) Ry(second) Rz(third): about z, the new y, the newest z.
EulerAngles zyz_angles(const Eigen::Matrix3d& rotation);

}  // namespace calibrd::api
