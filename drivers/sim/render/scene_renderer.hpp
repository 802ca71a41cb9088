// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/sim/render/bodies.hpp"
#include "drivers/sim/render/rasterizer.hpp"
#include "drivers/sim/render/sample_grid.hpp"
#include "drivers/sim/render/tiles.hpp"

namespace calibrd::sim {

/// What the sensor would see without any error, one value per pixel, row by row.
struct PixelTruth {
  explicit PixelTruth(std::size_t pixels)
      : depth_m(pixels), cosine(pixels), mixed_m(pixels), echo(pixels), robot(pixels) {}
  std::vector<float> depth_m;   ///< along the optical axis, through the pixel's centre; 0 = nothing
  std::vector<float> cosine;    ///< of the incidence at the centre; 0 = nothing
  std::vector<float> mixed_m;   ///< on edges in depth: what a mixture of all the pixel sees reads; else 0
  std::vector<float> echo;      ///< albedo * cos / distance^2 over the pixel's whole area, 1/m^2
  std::vector<std::uint8_t> robot;  ///< 1 where the centre sees the robot
};

/// Renders the cell as one sensor sees it. What stands still is drawn once per sensor pose and kept; each frame
/// redraws only the tiles in which something moves. One thread; `cell` must outlive it.
class SceneRenderer {
 public:
  SceneRenderer(const Cell& cell, const CameraParameters& camera);

  /// The cell at one moment. Afterwards truth() and changed() hold for it.
  void render(const WorldState& state, const Eigen::Isometry3d& T_base_sensor, double texture, std::int64_t now_ns);

  const PixelTruth& truth() const { return truth_; }
  const Tiles& changed() const { return changed_; }  ///< since the frame before
  const SampleGrid& grid() const { return grid_; }

 private:
  /// What the kept picture of the standing bodies was drawn from.
  struct Key {
    PoseValues T_base_sensor;
    std::array<ObjectState, kMaxObjects> objects;
    OtherRobotState other_robot;
    double texture;
    bool operator==(const Key&) const = default;
  };

  bool is_kept_picture_valid(const Key& key);
  void draw_standing(const WorldState& state);
  void restore(const Tiles& tiles);
  void draw(const Body& body, SampleBuffer& buffer, Tiles& touched);
  void resolve_tile(const PixelRect& rect);
  void resolve_pixel(int x, int y);
  void resolve_mixed(std::size_t pixel, std::size_t first_sample);
  bool is_uniform(std::size_t first_sample) const;
  float echo_of(std::size_t sample, float texture) const;
  float texture_at(std::size_t sample) const;
  bool is_edge(std::size_t first_sample) const;

  const Cell& cell_;
  std::vector<Mesh> person_;
  SampleGrid grid_;
  Rasterizer rasterizer_;
  SampleBuffer standing_, samples_;
  std::vector<Facet> facets_;   // those of the standing bodies first
  std::vector<Body> bodies_;    // likewise
  std::vector<Eigen::Isometry3f> T_body_sensor_;
  std::size_t standing_facets_ = 0, standing_bodies_ = 0;
  PixelTruth truth_;
  Tiles moved_, changed_;
  Eigen::Isometry3d T_sensor_base_ = Eigen::Isometry3d::Identity();
  float texture_ = 0;
  std::optional<Key> key_;
};

}  // namespace calibrd::sim
