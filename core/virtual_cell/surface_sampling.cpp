// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/virtual_cell/surface_sampling.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <random>

namespace calibrd {
namespace {

struct Facet {
  int link;
  std::array<Eigen::Vector3d, 3> corners;  // link frame
  double area_sum;                         // of this facet and all before it
};

std::vector<Facet> list_facets(const RobotModel& robot) {
  std::vector<Facet> facets;
  double area_sum = 0;
  for (std::size_t link = 0; link < robot.links().size(); ++link) {
    const TriangleMesh& mesh = robot.links()[link].surface;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::array corners{mesh.vertices[a].cast<double>().eval(), mesh.vertices[b].cast<double>().eval(),
                               mesh.vertices[c].cast<double>().eval()};
      area_sum += 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
      facets.push_back({static_cast<int>(link), corners, area_sum});
    }
  }
  return facets;
}

}  // namespace

std::vector<SurfaceSample> sample_surface(const RobotModel& robot, std::span<const double> positions,
                                          std::size_t count, std::uint64_t seed) {
  const std::vector<Facet> facets = list_facets(robot);
  if (facets.empty()) return {};
  const std::vector<Pose> T_base_link = robot.forward_kinematics(positions);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<SurfaceSample> samples;
  samples.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double target = uniform(random) * facets.back().area_sum;
    const auto facet = std::ranges::upper_bound(facets, target, {}, &Facet::area_sum);
    const Facet& hit = facet == facets.end() ? facets.back() : *facet;
    // Uniform in a triangle: the square root makes up for the corner where rows get shorter.
    const double s = std::sqrt(uniform(random)), t = uniform(random);
    const auto& [a, b, c] = hit.corners;
    const Pose& T = T_base_link[static_cast<std::size_t>(hit.link)];
    samples.push_back({T * ((1 - s) * a + s * (1 - t) * b + s * t * c),
                       T.linear() * (b - a).cross(c - a).normalized(), hit.link});
  }
  return samples;
}

}  // namespace calibrd
