// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/surface_cloud.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace calibrd {
namespace {

using Lanes = Eigen::Array4f;

/// The points around one cell, coordinate by coordinate, in fours: what four-wide arithmetic reads best.
class Block {
 public:
  void gather(const std::vector<Eigen::Vector3f>& points, std::span<const PointGrid::Range> ranges) {
    x.clear(), y.clear(), z.clear();
    for (const PointGrid::Range range : ranges)
      for (std::uint32_t i = range.begin; i < range.end; ++i) push(points[i]);
    constexpr float kFarAway = 1e15F;  // its square is still finite
    while (x.size() % 4 != 0) push(Eigen::Vector3f::Constant(kFarAway));
  }
  std::vector<float> x, y, z;

 private:
  void push(const Eigen::Vector3f& p) {
    x.push_back(p.x());
    y.push_back(p.y());
    z.push_back(p.z());
  }
};

/// Sums over the neighbours of one point, relative to it, in units of the radius: they stay near 1 for every
/// scale of cloud. Weights fall to 0 at the radius.
struct Moments {
  float weight = 0, squared_weights = 0;
  Eigen::Vector3f first = Eigen::Vector3f::Zero();
  Eigen::Matrix3f second = Eigen::Matrix3f::Zero();
};

Moments moments_about(const Eigen::Vector3f& centre, const Block& block, float inverse_radius) {
  Lanes w1 = Lanes::Zero(), w2 = w1, sx = w1, sy = w1, sz = w1, xx = w1, xy = w1, xz = w1, yy = w1, yz = w1,
        zz = w1;
  for (std::size_t i = 0; i < block.x.size(); i += 4) {
    const Lanes x = (Eigen::Map<const Lanes>(&block.x[i]) - centre.x()) * inverse_radius;
    const Lanes y = (Eigen::Map<const Lanes>(&block.y[i]) - centre.y()) * inverse_radius;
    const Lanes z = (Eigen::Map<const Lanes>(&block.z[i]) - centre.z()) * inverse_radius;
    const Lanes w = (1 - (x * x + y * y + z * z)).max(0);
    const Lanes wx = w * x, wy = w * y, wz = w * z;
    w1 += w;
    w2 += w * w;
    sx += wx;
    sy += wy;
    sz += wz;
    xx += wx * x;
    xy += wx * y;
    xz += wx * z;
    yy += wy * y;
    yz += wy * z;
    zz += wz * z;
  }
  Moments sums;
  sums.weight = w1.sum();
  sums.squared_weights = w2.sum();
  sums.first << sx.sum(), sy.sum(), sz.sum();
  sums.second << xx.sum(), xy.sum(), xz.sum(), xy.sum(), yy.sum(), yz.sum(), xz.sum(), yz.sum(), zz.sum();
  return sums;
}

Eigen::Matrix3f adjugate(const Eigen::Matrix3f& m) {  // of a symmetric matrix
  Eigen::Matrix3f a;
  a.col(0) = m.col(1).cross(m.col(2));
  a.col(1) = m.col(2).cross(m.col(0));
  a.col(2) = m.col(0).cross(m.col(1));
  return a;
}

struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  float variance = 0;
};

/// The direction of least scatter. The adjugate's eigenvalues are products of two of the covariance's, so
/// the normal's is by far its largest, and a few multiplications leave nothing else: no root is solved for.
Plane plane_of(const Moments& sums) {
  const float independent = sums.weight * sums.weight / sums.squared_weights;
  constexpr float kFewest = 3;
  if (!(independent > kFewest)) return {};
  const Eigen::Vector3f mean = sums.first / sums.weight;
  const Eigen::Matrix3f covariance = sums.second / sums.weight - mean * mean.transpose();
  const Eigen::Matrix3f once = adjugate(covariance);
  const float trace = once.trace();
  if (!(trace > 1e-12F)) return {};  // points on a line
  const Eigen::Matrix3f twice = once.lazyProduct(once) / (trace * trace);
  int largest = 0;
  twice.diagonal().maxCoeff(&largest);
  Plane plane;
  plane.normal = (twice.lazyProduct(twice.col(largest))).normalized();
  const float thickness = std::max(plane.normal.dot(covariance * plane.normal), 0.0F);
  const float width = 0.5F * (covariance.trace() - thickness);
  plane.variance = thickness / (width * independent);
  return plane;
}

}  // namespace

float neighbour_radius_m(std::span<const Eigen::Vector3f> points, double neighbours) {
  constexpr int kCells = 48;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : points) box.extend(p);
  const float side = box.sizes().maxCoeff() / kCells;
  if (!(side > 0)) return 1;
  std::vector<char> met(std::size_t{kCells + 1} * (kCells + 1) * (kCells + 1), 0);
  double cells = 0;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3i c = ((p - box.min()) / side).cast<int>();
    char& cell = met[static_cast<std::size_t>((c.z() * (kCells + 1) + c.y()) * (kCells + 1) + c.x())];
    cells += cell == 0;
    cell = 1;
  }
  // A surface in general position meets 1.5 cells per cell side squared of its area.
  const double area = cells / 1.5 * side * side;
  const double per_area = static_cast<double>(points.size()) / area;
  return static_cast<float>(std::sqrt(neighbours / (std::numbers::pi * per_area)));
}

SurfaceCloud make_surface(std::span<const Eigen::Vector3f> points, float radius_m) {
  SurfaceCloud surface{PointGrid(points, radius_m), {}, {}};
  surface.normals.resize(points.size());
  surface.normal_variance.resize(points.size());
  const auto& sorted = surface.grid.points();
  tbb::parallel_for(tbb::blocked_range<int>(0, surface.grid.rows(), 64), [&](const auto& rows) {
    Block block;
    surface.grid.for_each_cell(rows.begin(), rows.end(), [&](PointGrid::Range own, auto ranges) {
      block.gather(sorted, ranges);
      for (std::uint32_t i = own.begin; i < own.end; ++i) {
        const Plane plane = plane_of(moments_about(sorted[i], block, 1 / radius_m));
        surface.normals[i] = plane.normal;
        surface.normal_variance[i] = plane.variance;
      }
    });
  });
  return surface;
}

SurfaceCloud thinned(const SurfaceCloud& surface, std::size_t step, float cell_m) {
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < surface.size(); i += step) points.push_back(surface.grid.points()[i]);
  SurfaceCloud thin{PointGrid(points, cell_m), {}, {}};
  for (const std::uint32_t place : thin.grid.order()) {
    thin.normals.push_back(surface.normals[place * step]);
    thin.normal_variance.push_back(surface.normal_variance[place * step]);
  }
  return thin;
}

}  // namespace calibrd
