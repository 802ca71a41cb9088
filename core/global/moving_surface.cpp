// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/moving_surface.hpp"

#include <algorithm>

#include "core/virtual_cell/surface_sampling.hpp"

namespace calibrd {
namespace {

constexpr double kMoved_m = 0.03;
constexpr std::uint64_t kSeed = 1;

/// How far `p_link` of a link travels at most from where the first view has it.
double travel_m(std::span<const RegistrationView> views, std::size_t link, const Eigen::Vector3d& p_link) {
  const Eigen::Vector3d first = views.front().cell.link_poses()[link] * p_link;
  double furthest = 0;
  for (const RegistrationView& view : views.subspan(1))
    furthest = std::max(furthest, (view.cell.link_poses()[link] * p_link - first).norm());
  return furthest;
}

}  // namespace

std::vector<PosedSurface> sample_moving_surface(std::span<const RegistrationView> views, std::size_t count) {
  std::vector<PosedSurface> surfaces(views.size());
  if (views.empty()) return surfaces;
  const RobotModel& robot = views.front().cell.robot();
  const auto& T_base_link = views.front().cell.link_poses();
  for (const SurfaceSample& sample : sample_surface(robot, views.front().reported_joints, count, kSeed)) {
    const auto link = static_cast<std::size_t>(sample.link);
    const Eigen::Vector3d p_link = T_base_link[link].inverse() * sample.point;
    const Eigen::Vector3d n_link = T_base_link[link].linear().transpose() * sample.normal;
    if (views.size() > 1 && travel_m(views, link, p_link) < kMoved_m) continue;
    for (std::size_t v = 0; v < views.size(); ++v) {
      const Pose& T = views[v].cell.link_poses()[link];
      surfaces[v].points.push_back((T * p_link).cast<float>());
      surfaces[v].normals.push_back((T.linear() * n_link).cast<float>());
    }
  }
  return surfaces;
}

}  // namespace calibrd
