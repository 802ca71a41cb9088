// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/render_score.hpp"

#include <cmath>

namespace calibrd {
namespace {

double share(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

/// The camera of every `reduction`-th pixel: pixel (x, y) of it sees along pixel (x, y) * reduction.
CameraModel every_nth(const CameraModel& camera, int reduction) {
  CameraModel sparse = camera;
  sparse.width = (camera.width + reduction - 1) / reduction;
  sparse.height = (camera.height + reduction - 1) / reduction;
  sparse.fx /= reduction;
  sparse.fy /= reduction;
  sparse.cx /= reduction;
  sparse.cy /= reduction;
  return sparse;
}

}  // namespace

double RenderScore::value() const {
  const double fit = share(agreeing, predicted) - share(seen_through, predicted);
  return moving > 0 ? 0.5 * (fit + share(explained, moving)) : fit;
}

RenderScore render_score(std::span<const RegistrationView> views,
                         std::span<const std::vector<std::uint8_t>> moving, const CameraModel& camera,
                         const Pose& T_base_sensor, const RenderScoreSettings& settings) {
  const CameraModel sparse = every_nth(camera, settings.reduction);
  const auto tolerance = static_cast<float>(settings.tolerance_m);
  RenderScore score;
  VirtualMeasurement prediction;
  for (std::size_t v = 0; v < views.size(); ++v) {
    views[v].cell.measure(sparse, T_base_sensor, prediction);
    for (int y = 0; y < sparse.height; ++y) {
      for (int x = 0; x < sparse.width; ++x) {
        const auto full = static_cast<std::size_t>(y * settings.reduction) *
                              static_cast<std::size_t>(camera.width) +
                          static_cast<std::size_t>(x * settings.reduction);
        const float z = prediction.depth_m[static_cast<std::size_t>(y * sparse.width + x)];
        const float measured = views[v].depth_m[full];
        if (measured <= 0) continue;
        const bool agrees = z > 0 && std::abs(measured - z) < tolerance;
        if (!moving.empty() && moving[v][full] != 0) {
          ++score.moving;
          score.explained += agrees ? 1 : 0;
        }
        if (z <= 0) continue;
        ++score.predicted;
        score.agreeing += agrees ? 1 : 0;
        score.seen_through += measured > z + tolerance ? 1 : 0;
      }
    }
  }
  return score;
}

}  // namespace calibrd
