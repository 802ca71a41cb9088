// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "drivers/sim/render/sample_grid.hpp"
#include "drivers/sim/render/tiles.hpp"
#include "drivers/sim/world/mesh.hpp"

namespace calibrd::sim {

/// A triangle as drawn.
struct Facet {
  Eigen::Vector3f normal;  ///< unit, sensor frame, towards the sensor
  std::uint32_t body = 0;
};

/// z-buffer rasteriser on homogeneous edge functions (Olano and Greer 1997): a sample belongs to a triangle when its
/// ray does, so the distorted rays need no straight edges in the image and nothing is ever clipped. Both sides of a
/// triangle are seen, but for solids. One thread.
class Rasterizer {
 public:
  explicit Rasterizer(const SampleGrid& grid) : grid_(grid) {}

  /// Draws a mesh into `buffer`, appends its facets to `facets` and marks what it may have touched.
  void draw(const Mesh& mesh, const Eigen::Isometry3d& T_sensor_body, std::uint32_t body, SampleBuffer& buffer,
            std::vector<Facet>& facets, Tiles& touched);

 private:
  struct Vertex {
    Eigen::Vector3d point;  // sensor frame
    Eigen::Vector2d pixel;
    bool in_view;           // within the range of the rays, where the lens's polynomial can be trusted
  };
  struct SampleRect {
    int x0, y0, x1, y1;
  };

  void place(const Mesh& mesh, const Eigen::Isometry3d& T_sensor_body);
  bool is_outside(const Vertex& a, const Vertex& b, const Vertex& c) const;
  PixelRect bounds(const Vertex& a, const Vertex& b, const Vertex& c, SampleRect& samples) const;
  void fill(const Vertex& a, const Vertex& b, const Vertex& c, double volume, const SampleRect& rect,
            std::uint32_t body, SampleBuffer& buffer, std::vector<Facet>& facets) const;

  const SampleGrid& grid_;
  std::vector<Vertex> vertices_;
};

}  // namespace calibrd::sim
