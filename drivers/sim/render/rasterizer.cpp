// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/render/rasterizer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace calibrd::sim {
namespace {

constexpr double kNear_m = 0.02;
constexpr double kBulge = 0.1;  // of a triangle's size in the image: how far a lens bends its edges, amply
constexpr double kSlack_px = 1e-3;

/// The edge functions and the plane of one triangle, rounded to float once and the same way for both triangles at an
/// edge, so that they never leave a gap between them.
struct Planes {
  std::array<float, 3> e0, e1, e2, normal;
  float offset;
};

std::array<float, 3> rounded(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// Four samples at a time: most triangles are a few samples wide, too few for a compiler's own loops to pay.
using Floats = float __attribute__((vector_size(4 * kRowStep)));
using Words = std::uint32_t __attribute__((vector_size(4 * kRowStep)));

template <class Lanes, class T>
Lanes load(const T* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}

Floats along(const std::array<float, 3>& plane, Floats x, Floats y) { return plane[0] * x + plane[1] * y + plane[2]; }

void fill_four(const Planes& t, const float* ray_x, const float* ray_y, std::uint32_t facet, float* depth,
               std::uint32_t* facets) {
  const Floats x = load<Floats>(ray_x), y = load<Floats>(ray_y);
  const auto inside = (along(t.e0, x, y) >= 0.0F) & (along(t.e1, x, y) >= 0.0F) & (along(t.e2, x, y) >= 0.0F);
  std::array<std::uint64_t, 2> any;
  std::memcpy(any.data(), &inside, sizeof(inside));
  if ((any[0] | any[1]) == 0) return;
  const Floats before = load<Floats>(depth), z = t.offset / along(t.normal, x, y);
  const auto hit = inside & (z > 0.0F) & (z < before);
  const Floats nearest = hit ? z : before;
  const Words seen = hit ? Words{} + facet : load<Words>(facets);
  std::memcpy(depth, &nearest, sizeof(nearest));
  std::memcpy(facets, &seen, sizeof(seen));
}

}  // namespace

void Rasterizer::place(const Mesh& mesh, const Eigen::Isometry3d& T_sensor_body) {
  vertices_.clear();
  for (const auto& vertex : mesh.vertices) {
    Vertex v{T_sensor_body * vertex.cast<double>(), {0, 0}, false};
    if (v.point.z() > kNear_m) {
      const Eigen::Vector2d n = v.point.head<2>() / v.point.z();
      v.in_view = (n.array() >= grid_.lowest.array()).all() && (n.array() <= grid_.highest.array()).all();
      if (v.in_view) v.pixel = grid_.camera.pixel(n);
    }
    vertices_.push_back(v);
  }
}

bool Rasterizer::is_outside(const Vertex& a, const Vertex& b, const Vertex& c) const {
  const auto all = [&](auto beyond) { return beyond(a.point) && beyond(b.point) && beyond(c.point); };
  // In homogeneous form, p.x > highest * p.z, these planes hold behind the sensor too.
  return all([](const auto& p) { return p.z() <= 0; }) ||
         all([&](const auto& p) { return p.x() < grid_.lowest.x() * p.z(); }) ||
         all([&](const auto& p) { return p.x() > grid_.highest.x() * p.z(); }) ||
         all([&](const auto& p) { return p.y() < grid_.lowest.y() * p.z(); }) ||
         all([&](const auto& p) { return p.y() > grid_.highest.y() * p.z(); });
}

PixelRect Rasterizer::bounds(const Vertex& a, const Vertex& b, const Vertex& c, SampleRect& samples) const {
  const CameraParameters& p = grid_.camera.parameters();
  Eigen::Vector2d low(-1, -1), high(p.width, p.height);  // the whole image, unless more is known
  if (a.in_view && b.in_view && c.in_view) {
    low = a.pixel.cwiseMin(b.pixel).cwiseMin(c.pixel);
    high = a.pixel.cwiseMax(b.pixel).cwiseMax(c.pixel);
    const double margin = kSlack_px + (grid_.camera.is_distorted() ? kBulge * (high - low).maxCoeff() : 0.0);
    low.array() -= margin;
    high.array() += margin;
  } else if (a.point.z() > kNear_m && b.point.z() > kNear_m && c.point.z() > kNear_m) {
    const auto pinhole = [&](const Vertex& v) {
      return Eigen::Vector2d(p.cx + p.fx * v.point.x() / v.point.z(), p.cy + p.fy * v.point.y() / v.point.z());
    };
    const Eigen::Vector2d pa = pinhole(a), pb = pinhole(b), pc = pinhole(c);
    low = pa.cwiseMin(pb).cwiseMin(pc).array() - grid_.largest_displacement_px - kSlack_px;
    high = pa.cwiseMax(pb).cwiseMax(pc).array() + grid_.largest_displacement_px + kSlack_px;
  }
  low = low.cwiseMax(Eigen::Vector2d(-1, -1));
  high = high.cwiseMin(Eigen::Vector2d(p.width, p.height));
  // A sample lies at most a third of its pitch off the regular grid, whose middle sample is the pixel's centre.
  const auto first = [](double px) { return static_cast<int>(std::ceil(kSubSamples * px + 1 - 1.0 / 3)); };
  const auto last = [](double px) { return static_cast<int>(std::floor(kSubSamples * px + 1 + 1.0 / 3)); };
  samples = {std::max(first(low.x()), 0), std::max(first(low.y()), 0), std::min(last(high.x()) + 1, grid_.width),
             std::min(last(high.y()) + 1, grid_.height)};
  return {samples.x0 / kSubSamples - 1, samples.y0 / kSubSamples - 1, (samples.x1 - 1) / kSubSamples + 2,
          (samples.y1 - 1) / kSubSamples + 2};  // one pixel more all round, for the lens's blur
}

void Rasterizer::fill(const Vertex& a, const Vertex& b, const Vertex& c, double volume, const SampleRect& rect,
                      std::uint32_t body, SampleBuffer& buffer, std::vector<Facet>& facets) const {
  const double side = volume > 0 ? 1 : -1;
  const Eigen::Vector3d normal = side * (b.point - a.point).cross(c.point - a.point);
  const Planes planes{rounded(side * b.point.cross(c.point)), rounded(side * c.point.cross(a.point)),
                      rounded(side * a.point.cross(b.point)), rounded(normal),
                      static_cast<float>(normal.dot(a.point))};
  const auto facet = static_cast<std::uint32_t>(facets.size());
  facets.push_back({(-normal.normalized()).cast<float>(), body});
  for (int sy = rect.y0; sy < rect.y1; ++sy) {
    const std::size_t end = grid_.index(rect.x1, sy);
    for (std::size_t at = grid_.index(rect.x0 / kRowStep * kRowStep, sy); at < end; at += kRowStep)
      fill_four(planes, &grid_.ray_x[at], &grid_.ray_y[at], facet, &buffer.depth[at], &buffer.facet[at]);
  }
}

void Rasterizer::draw(const Mesh& mesh, const Eigen::Isometry3d& T_sensor_body, std::uint32_t body,
                      SampleBuffer& buffer, std::vector<Facet>& facets, Tiles& touched) {
  place(mesh, T_sensor_body);
  for (const auto& triangle : mesh.triangles) {
    const Vertex &a = vertices_[triangle[0]], &b = vertices_[triangle[1]], &c = vertices_[triangle[2]];
    if (is_outside(a, b, c)) continue;
    const double volume = a.point.dot(b.point.cross(c.point));
    if (volume == 0 || (mesh.solid && volume > 0)) continue;  // seen edge on, or from inside
    SampleRect samples;
    const PixelRect pixels = bounds(a, b, c, samples);
    if (samples.x0 >= samples.x1 || samples.y0 >= samples.y1) continue;
    touched.mark(pixels);
    fill(a, b, c, volume, samples, body, buffer, facets);
  }
}

}  // namespace calibrd::sim
