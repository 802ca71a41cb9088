// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/robot/robot_model.hpp"

namespace calibrd {

/// How fast every link moves at one moment, from where it is shortly before and after.
class LinkMotion {
 public:
  /// T_base_link of every link, in the robot's order; `span_s` passes between before and after.
  LinkMotion(std::span<const Pose> before, std::span<const Pose> now, std::span<const Pose> after,
             double span_s);

  /// Velocity (m/s, base frame) of a point of `link` that is at `p_base` now.
  Eigen::Vector3d velocity(int link, const Eigen::Vector3d& p_base) const {
    const auto& rate = rates_[static_cast<std::size_t>(link)];
    return rate.leftCols<3>() * p_base + rate.col(3);
  }

 private:
  std::vector<Eigen::Matrix<double, 3, 4>> rates_;  // velocity = rate · (p_base, 1)
};

/// How far any point of the robot's surface moves between postures, by the corners of its links' boxes: never
/// less than the truth. Immutable: safe to use from any thread. The robot must outlive it.
class LinkReach {
 public:
  explicit LinkReach(const RobotModel& robot);

  /// The longest way of any corner from one posture to the other, m (as the crow flies).
  double farthest_m(std::span<const double> from, std::span<const double> to) const;

  /// The largest change of any corner's velocity from (a to b) to (b to c), m/s.
  double velocity_change_m_s(std::span<const double> a, std::span<const double> b, std::span<const double> c,
                             double seconds_ab, double seconds_bc) const;

 private:
  std::vector<Eigen::Vector3d> corners_at(std::span<const double> positions) const;

  struct Corners {
    std::size_t link;
    std::array<Eigen::Vector3d, 8> p_link;
  };
  const RobotModel& robot_;
  std::vector<Corners> corners_;
};

}  // namespace calibrd
