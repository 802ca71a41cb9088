// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/drift/window_support.hpp"
#include "tests/core/drift/watched_room.hpp"

namespace calibrd::test {

inline constexpr double kPushed_m = 0.008, kSlid_m = 0.0035;  // the robot's word agrees with the latter, too

/// Wall and floor leave open a slide along both, the sensor's x; the left faces of boxes show it. Sensor
/// axes.
inline Room corner(std::initializer_list<double> boxes_y) {
  Room room = Room::single_wall();
  room.blocks.push_back({{0, 1.1, 0}, {20, 0.1, 20}});
  for (const double y : boxes_y) room.blocks.push_back({{0.6, y, 1.15}, {0.4, 0.3, 0.9}});
  return room;
}

inline Pose in_sensor_axes(double x, double y, double z) {
  return true_T_base_sensor() * Pose(Eigen::Translation3d(x, y, z));
}

class PushedBox : public WatchedRoom {
 protected:
  explicit PushedBox(Room room = corner({0.3}), const DriftSettings& settings = {})
      : WatchedRoom(std::move(room), settings) {}
  BackgroundObservation seen_from(const Pose& T_base_sensor) {
    BackgroundMatcher matcher(watch_.background());
    const View view = room_.seen_from(T_base_sensor, joints_now());
    return matcher.match(view.depth, mask_of(room_, joints_now()), true_T_base_sensor().linear());
  }
  static double along_x(const Vector6d& shift) {
    return shift.tail<3>().dot(true_T_base_sensor().linear().col(0));
  }
  static double sigmas(const Vector6d& shift, const Matrix6d& covariance) {
    return std::sqrt(shift.dot(covariance.ldlt().solve(shift)));
  }
};

}  // namespace calibrd::test
