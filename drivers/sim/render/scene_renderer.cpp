// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/render/scene_renderer.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/sim/render/texture.hpp"
#include "drivers/sim/world/person.hpp"

namespace calibrd::sim {
namespace {

constexpr float kEdge_m = 0.02F;  // a step in depth within one pixel, on top of what a slanted surface makes

constexpr float kGrazing = 1e-3F;

/// Calls visit(index) for the samples of the pixel whose first sample is `first`.
template <class Visit>
void each_sample(const SampleGrid& grid, std::size_t first, Visit visit) {
  for (int j = 0; j < kSubSamples; ++j)
    for (int i = 0; i < kSubSamples; ++i) visit(first + static_cast<std::size_t>(j * grid.width + i));
}

}  // namespace

SceneRenderer::SceneRenderer(const Cell& cell, const CameraParameters& camera)
    : cell_(cell),
      person_(person_parts()),
      grid_(camera),
      rasterizer_(grid_),
      standing_(grid_),
      samples_(grid_),
      truth_(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height)),
      moved_(camera.width, camera.height),
      changed_(camera.width, camera.height) {}

bool SceneRenderer::is_kept_picture_valid(const Key& key) {
  const bool valid = key_ && *key_ == key;
  key_ = key;
  return valid;
}

void SceneRenderer::draw(const Body& body, SampleBuffer& buffer, Tiles& touched) {
  const Eigen::Isometry3d T_sensor_body = T_sensor_base_ * body.T_base_body;
  const auto index = static_cast<std::uint32_t>(bodies_.size());
  bodies_.push_back(body);
  T_body_sensor_.push_back(T_sensor_body.inverse().cast<float>());
  rasterizer_.draw(*body.mesh, T_sensor_body, index, buffer, facets_, touched);
}

void SceneRenderer::draw_standing(const WorldState& state) {
  bodies_.clear();
  T_body_sensor_.clear();
  facets_.clear();
  std::fill(standing_.depth.begin(), standing_.depth.end(), kNothing);
  Tiles ignored = changed_;
  for (const Body& body : standing_bodies(cell_, state)) draw(body, standing_, ignored);
  standing_facets_ = facets_.size();
  standing_bodies_ = bodies_.size();
}

void SceneRenderer::restore(const Tiles& tiles) {
  tiles.each([&](const PixelRect& rect) {
    const auto count = kSubSamples * (rect.x1 - rect.x0);
    for (int sy = kSubSamples * rect.y0; sy < kSubSamples * rect.y1; ++sy) {
      const std::size_t at = grid_.index(kSubSamples * rect.x0, sy);
      std::copy_n(&standing_.depth[at], count, &samples_.depth[at]);
      std::copy_n(&standing_.facet[at], count, &samples_.facet[at]);
    }
  });
}

void SceneRenderer::render(const WorldState& state, const Eigen::Isometry3d& T_base_sensor, double texture,
                           std::int64_t now_ns) {
  changed_ = moved_;  // what moved in the last frame has to go
  if (!is_kept_picture_valid({PoseValues::of(T_base_sensor), state.objects, state.other_robot, texture})) {
    texture_ = static_cast<float>(texture);
    T_sensor_base_ = T_base_sensor.inverse();
    draw_standing(state);
    changed_.mark_all();
  }
  restore(changed_);
  bodies_.resize(standing_bodies_);
  T_body_sensor_.resize(standing_bodies_);
  facets_.resize(standing_facets_);
  moved_.clear();
  for (const Body& body : moving_bodies(cell_, person_, state, now_ns)) draw(body, samples_, moved_);
  changed_.add(moved_);
  changed_.each([&](const PixelRect& rect) { resolve_tile(rect); });
}

float SceneRenderer::texture_at(std::size_t sample) const {
  const Facet& facet = facets_[samples_.facet[sample]];
  const Surface& surface = bodies_[facet.body].surface;
  const float depth = texture_ * surface.texture;
  if (depth <= 0) return 1;
  const float z = samples_.depth[sample];
  const Eigen::Vector3f point(grid_.ray_x[sample] * z, grid_.ray_y[sample] * z, z);
  return 1 + depth * mottling(T_body_sensor_[facet.body] * point, surface.seed);
}

float SceneRenderer::echo_of(std::size_t sample, float texture) const {
  const float z = samples_.depth[sample];
  if (z == kNothing) return 0;
  const Facet& facet = facets_[samples_.facet[sample]];
  const Eigen::Vector3f ray(grid_.ray_x[sample], grid_.ray_y[sample], 1);
  const float length2 = ray.squaredNorm();
  // cosine / distance^2 = (-n.ray / |ray|) / (z^2 |ray|^2)
  return bodies_[facet.body].surface.albedo * texture * -facet.normal.dot(ray) / (z * z * length2 * std::sqrt(length2));
}

bool SceneRenderer::is_uniform(std::size_t first) const {
  const std::uint32_t facet = samples_.facet[first];
  const bool hit = samples_.depth[first] != kNothing;
  bool uniform = true;
  each_sample(grid_, first, [&](std::size_t at) {
    uniform = uniform && (samples_.depth[at] != kNothing) == hit && (!hit || samples_.facet[at] == facet);
  });
  return uniform;
}

bool SceneRenderer::is_edge(std::size_t first) const {
  float nearest = kNothing, farthest = 0, slope = 0;
  each_sample(grid_, first, [&](std::size_t at) {
    nearest = std::min(nearest, samples_.depth[at]);
    farthest = std::max(farthest, samples_.depth[at]);
    if (samples_.depth[at] == kNothing) return;
    const Eigen::Vector3f& n = facets_[samples_.facet[at]].normal;
    const Eigen::Vector3f ray(grid_.ray_x[at], grid_.ray_y[at], 1);
    slope = std::max(slope, n.head<2>().norm() / std::max(-n.dot(ray), kGrazing));
  });
  const float pixel_m = nearest / static_cast<float>(grid_.camera.parameters().fx);
  return farthest - nearest > kEdge_m + 1.5F * slope * pixel_m;
}

void SceneRenderer::resolve_mixed(std::size_t pixel, std::size_t first) {
  float echo = 0, echo_depth = 0, texture = 1;
  std::uint32_t textured = UINT32_MAX;  // mottling is coarser than a pixel: once per body is enough
  each_sample(grid_, first, [&](std::size_t at) {
    if (samples_.depth[at] == kNothing) return;
    const std::uint32_t body = facets_[samples_.facet[at]].body;
    if (body != textured) texture = texture_at(at);
    textured = body;
    const float e = echo_of(at, texture);
    echo += e;
    echo_depth += e * samples_.depth[at];
  });
  truth_.echo[pixel] = echo / (kSubSamples * kSubSamples);
  truth_.mixed_m[pixel] = echo > 0 && is_edge(first) ? echo_depth / echo : 0;
}

void SceneRenderer::resolve_pixel(int x, int y) {
  const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(grid_.camera.parameters().width) +
                            static_cast<std::size_t>(x);
  const std::size_t first = grid_.index(kSubSamples * x, kSubSamples * y);
  const std::size_t centre = grid_.index(kSubSamples * x + 1, kSubSamples * y + 1);
  const bool hit = samples_.depth[centre] != kNothing;
  truth_.depth_m[pixel] = 0;
  truth_.cosine[pixel] = 0;
  truth_.robot[pixel] = 0;
  if (hit) {
    const Facet& facet = facets_[samples_.facet[centre]];
    const Eigen::Vector3f ray(grid_.ray_x[centre], grid_.ray_y[centre], 1);
    truth_.depth_m[pixel] = samples_.depth[centre];
    truth_.cosine[pixel] = -facet.normal.dot(ray) / ray.norm();
    truth_.robot[pixel] = bodies_[facet.body].is_robot ? 1 : 0;
  }
  if (!is_uniform(first)) return resolve_mixed(pixel, first);
  truth_.echo[pixel] = hit ? echo_of(centre, texture_at(centre)) : 0;
  truth_.mixed_m[pixel] = 0;
}

void SceneRenderer::resolve_tile(const PixelRect& rect) {
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) resolve_pixel(x, y);
}

}  // namespace calibrd::sim
