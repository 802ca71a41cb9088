// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/timing/link_motion.hpp"

#include <algorithm>

namespace calibrd {

LinkMotion::LinkMotion(std::span<const Pose> before, std::span<const Pose> now, std::span<const Pose> after,
                       double span_s) {
  rates_.reserve(now.size());
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Eigen::Matrix4d rate =
        (after[i].matrix() - before[i].matrix()) / span_s * now[i].inverse().matrix();
    rates_.emplace_back(rate.topRows<3>());
  }
}

LinkReach::LinkReach(const RobotModel& robot) : robot_(robot) {
  for (std::size_t link = 0; link < robot.links().size(); ++link) {
    const auto& vertices = robot.links()[link].surface.vertices;
    if (vertices.empty()) continue;
    Eigen::Vector3f low = vertices.front(), high = low;
    for (const auto& vertex : vertices) {
      low = low.cwiseMin(vertex);
      high = high.cwiseMax(vertex);
    }
    Corners corners{link, {}};
    for (std::size_t i = 0; i < corners.p_link.size(); ++i)
      corners.p_link[i] = Eigen::Vector3d((i & 1U) ? high.x() : low.x(), (i & 2U) ? high.y() : low.y(),
                                          (i & 4U) ? high.z() : low.z());
    corners_.push_back(corners);
  }
}

std::vector<Eigen::Vector3d> LinkReach::corners_at(std::span<const double> positions) const {
  const auto T_base_link = robot_.forward_kinematics(positions);
  std::vector<Eigen::Vector3d> points;
  points.reserve(8 * corners_.size());
  for (const auto& corners : corners_)
    for (const auto& p_link : corners.p_link) points.push_back(T_base_link[corners.link] * p_link);
  return points;
}

double LinkReach::farthest_m(std::span<const double> from, std::span<const double> to) const {
  const auto a = corners_at(from), b = corners_at(to);
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (b[i] - a[i]).norm());
  return most;
}

double LinkReach::velocity_change_m_s(std::span<const double> a, std::span<const double> b,
                                      std::span<const double> c, double seconds_ab, double seconds_bc) const {
  const auto p = corners_at(a), q = corners_at(b), r = corners_at(c);
  double most = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
    most = std::max(most, ((r[i] - q[i]) / seconds_bc - (q[i] - p[i]) / seconds_ab).norm());
  return most;
}

}  // namespace calibrd
