// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/virtual_cell/virtual_cell.hpp"
#include "tests/core/virtual_cell/urdf_text.hpp"

namespace calibrd::test {

inline CameraModel small_camera() { return {161, 121, 150.0, 155.0, 82.3, 57.9, {0, 0, 0, 0, 0}}; }

/// A pose whose transpose and inverse are all different from it.
inline Pose skew_pose() {
  Pose T = looking_at({1.1, -0.7, 0.9}, {0.1, 0.05, 0.3});
  T.linear() = T.linear() * exp_so3({0.05, -0.03, 0.4});
  return T;
}

inline std::size_t pixel(const VirtualMeasurement& m, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(m.width) + static_cast<std::size_t>(x);
}

inline VirtualMeasurement measured(const VirtualCell& cell, const CameraModel& camera,
                                   const Pose& T_base_sensor) {
  VirtualMeasurement m;
  cell.measure(camera, T_base_sensor, m);
  return m;
}

/// First and last pixel of a row that show the robot; -1 when none does.
inline int first_column(const VirtualMeasurement& m, int row) {
  for (int x = 0; x < m.width; ++x)
    if (m.link[pixel(m, x, row)] >= 0) return x;
  return -1;
}

inline int last_column(const VirtualMeasurement& m, int row) {
  for (int x = m.width - 1; x >= 0; --x)
    if (m.link[pixel(m, x, row)] >= 0) return x;
  return -1;
}

}  // namespace calibrd::test
