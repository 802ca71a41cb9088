// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/pose_formats/euler_angles.hpp"

#include <cmath>
#include <numbers>

namespace calibrd::api {
namespace {

/// What leaving out the third angle costs in the rotation; must stay below the 1e-9 rad promised.
constexpr double kLocked = 1e-10;
constexpr double kHalfTurnSlack = 1e-12;

/// Into (-pi, pi]: rounding must not choose between -pi and pi. No minus zero.
double wrapped(double angle) {
  return angle <= -std::numbers::pi + kHalfTurnSlack ? std::numbers::pi : angle + 0.0;
}

EulerAngles wrapped(const EulerAngles& angles) {
  return {wrapped(angles.first), wrapped(angles.second), wrapped(angles.third)};
}

/// At the lock, where the cosine is rounding and may be negative, exactly a quarter turn.
double middle_angle(double sine, double cosine, bool locked) {
  return locked ? std::copysign(std::numbers::pi / 2, sine) : std::atan2(sine, cosine);
}

}  // namespace

EulerAngles zyx_angles(const Eigen::Matrix3d& r) {
  const bool locked = std::hypot(r(0, 0), r(1, 0)) < kLocked;
  const double z = locked ? std::atan2(-r(0, 1), r(1, 1)) : std::atan2(r(1, 0), r(0, 0));
  const double s = std::sin(z), c = std::cos(z);
  // What is left of the rotation without Rz: Ry(y) Rx(x), whose middle row is 0, cos x, -sin x.
  const double y = middle_angle(-r(2, 0), c * r(0, 0) + s * r(1, 0), locked);
  const double x = std::atan2(s * r(0, 2) - c * r(1, 2), c * r(1, 1) - s * r(0, 1));
  return wrapped({z, y, locked ? 0 : x});
}

EulerAngles xyz_angles(const Eigen::Matrix3d& r) {
  const bool locked = std::hypot(r(1, 2), r(2, 2)) < kLocked;
  const double x = locked ? std::atan2(r(2, 1), r(1, 1)) : std::atan2(-r(1, 2), r(2, 2));
  const double s = std::sin(x), c = std::cos(x);
  // What is left of the rotation without Rx: Ry(y) Rz(z), whose middle row is sin z, cos z, 0.
  const double y = middle_angle(r(0, 2), c * r(2, 2) - s * r(1, 2), locked);
  const double z = std::atan2(c * r(1, 0) + s * r(2, 0), c * r(1, 1) + s * r(2, 1));
  return wrapped({x, y, locked ? 0 : z});
}

EulerAngles zyz_angles(const Eigen::Matrix3d& r) {
  if (std::hypot(r(0, 2), r(1, 2)) < kLocked)
    return wrapped({std::atan2(-r(0, 1), r(1, 1)), r(2, 2) > 0 ? 0 : std::numbers::pi, 0});
  const double z = std::atan2(r(1, 2), r(0, 2));
  const double s = std::sin(z), c = std::cos(z);
  // What is left of the rotation without the first Rz: Ry(y) Rz(z'), whose middle row is sin z', cos z', 0.
  const double y = std::atan2(c * r(0, 2) + s * r(1, 2), r(2, 2));
  return wrapped({z, y, std::atan2(c * r(1, 0) - s * r(0, 0), c * r(1, 1) - s * r(0, 1))});
}

}  // namespace calibrd::api
