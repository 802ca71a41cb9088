// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/registration/point_grid.hpp"

namespace calibrd {

/// A point cloud as the surface it samples. Immutable: safe to read from any thread.
struct SurfaceCloud {
  PointGrid grid;
  std::vector<Eigen::Vector3f> normals;  ///< of grid.points(); unit, either sign; zero where none was found
  std::vector<float> normal_variance;    ///< of a normal's direction, rad²: what noise makes of it

  std::size_t size() const { return normals.size(); }
};

/// Within this radius (m) a point of the cloud has about `neighbours` neighbours. From the number of coarse
/// cells that the cloud meets, so that it costs one pass.
float neighbour_radius_m(std::span<const Eigen::Vector3f> points, double neighbours);

/// Normals from the neighbours within `radius_m`, near ones weighing more.
SurfaceCloud make_surface(std::span<const Eigen::Vector3f> points, float radius_m);

/// Every `step`-th point with its normal, on a grid of its own; neighbours thin out evenly.
SurfaceCloud thinned(const SurfaceCloud& surface, std::size_t step, float cell_m);

}  // namespace calibrd
