// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>

#include "core/drift/drift_watch.hpp"
#include "tests/core/drift/room.hpp"

namespace calibrd {

inline void PrintTo(DriftVerdict verdict, std::ostream* out) { *out << name_of(verdict); }

namespace test {

/// What a comparison with the robot says when it looks displaced as by a sensor that was perturbed so.
inline PoseCheck robot_seen(const Vector6d& delta) {
  PoseCheck check;
  check.enough_evidence = true;
  check.middle_base = {0.2, 0, 0.6};
  check.turn_shift = shift_of_point(check.middle_base - true_T_base_sensor().translation()) * delta;
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(1.5e-6), Eigen::Vector3d::Constant(1.2e-6);
  check.turn_shift_covariance = variance.asDiagonal();
  check.shift_sigmas =
      std::sqrt(check.turn_shift.dot(check.turn_shift_covariance.ldlt().solve(check.turn_shift)));
  check.agrees = check.shift_sigmas < 4;
  return check;
}

/// A watch that has learnt a room, and time that passes in it at 30 frames per second. The arm goes on to
/// another posture every second.
class WatchedRoom : public ::testing::Test {
 protected:
  static constexpr double kFrame_s = 1.0 / 30;

  explicit WatchedRoom(Room room = Room::furnished(), const DriftSettings& settings = {})
      : room_(std::move(room)), cell_(test_arm()), watch_(cell_, Room::camera(), settings) {
    learn();
  }

  void learn() {
    watch_.set_pose(true_T_base_sensor());
    std::vector<View> views;
    for (const auto& joints : postures(6)) views.push_back(room_.seen_from(true_T_base_sensor(), joints));
    watch_.learn(views);
  }

  std::vector<double> joints_now() const {
    static const auto all = postures(6);
    return all[static_cast<std::size_t>(now_s_) % all.size()];
  }

  /// Frames from where the sensor is now; before each `happen` may change what it likes.
  DriftVerdict watch_for(double seconds, const std::function<void()>& happen = {}) {
    for (const double end = now_s_ + seconds; now_s_ < end; now_s_ += kFrame_s, ++frames_) {
      if (happen) happen();
      View view = room_.seen_from(perturbed(true_T_base_sensor(), moved_), joints_now(), now_s_);
      for (int x = 0; x < dark_share_ * view.depth.width; ++x)
        for (int y = 0; y < view.depth.height; ++y) view.depth.raw[view.depth.index(x, y)] = 0;
      if (joints_lost_) view.joint_positions_rad.clear();
      watch_.add_frame(view);
      if (verdict() == DriftVerdict::sensor_moved && moved_at_frame_ < 0) moved_at_frame_ = frames_;
    }
    return verdict();
  }
  DriftVerdict verdict() const { return watch_.report().verdict; }
  /// In another posture every second, of which none comes again.
  void check(const Vector6d& robot_shift) {
    auto joints = joints_now();
    joints[0] += 0.3 * std::floor(now_s_);
    watch_.add_check(robot_seen(robot_shift), joints, now_s_);
  }

  Room room_;
  VirtualCell cell_;
  DriftWatch watch_;
  Vector6d moved_ = Vector6d::Zero();  // the sensor, as perturbed() takes it
  double dark_share_ = 0;              // of the picture, from its left
  bool joints_lost_ = false;
  double now_s_ = 100;
  int frames_ = 0, moved_at_frame_ = -1;
};

inline Vector6d shifted(double x, double y, double z) {
  Vector6d delta = Vector6d::Zero();
  delta.tail<3>() << x, y, z;
  return delta;
}

inline Vector6d turned(double x, double y, double z) {
  Vector6d delta = Vector6d::Zero();
  delta.head<3>() << x, y, z;
  return delta;
}

}  // namespace test
}  // namespace calibrd
