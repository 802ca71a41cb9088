// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/render_score.hpp"

#include <tbb/parallel_for.h>

#include <cmath>

namespace calibrd {
namespace {

double share(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

RenderScore score_of(const RegistrationView& view, const PixelMask& moving, const CameraModel& camera,
                     const Pose& T_base_sensor, const RenderScoreSettings& settings) {
  const CameraModel sparse = camera.subsampled(settings.reduction);
  const auto tolerance = static_cast<float>(settings.tolerance_m);
  VirtualMeasurement prediction;
  view.cell.measure(sparse, T_base_sensor, prediction);
  RenderScore score;
  for (int y = 0; y < sparse.height; ++y) {
    for (int x = 0; x < sparse.width; ++x) {
      const auto full =
          static_cast<std::size_t>(y * settings.reduction) * static_cast<std::size_t>(camera.width) +
          static_cast<std::size_t>(x * settings.reduction);
      const float z = prediction.depth_m[static_cast<std::size_t>(y * sparse.width + x)];
      const float measured = view.depth_m[full];
      if (measured <= 0) continue;
      const bool agrees = z > 0 && std::abs(measured - z) < tolerance;
      if (!moving.empty() && moving[full] != 0) {
        ++score.moving;
        score.explained += agrees ? 1 : 0;
      }
      if (z <= 0) continue;
      ++score.predicted;
      score.agreeing += agrees ? 1 : 0;
      score.seen_through += measured > z + tolerance ? 1 : 0;
    }
  }
  return score;
}

}  // namespace

void RenderScore::merge(const RenderScore& other) {
  predicted += other.predicted;
  agreeing += other.agreeing;
  seen_through += other.seen_through;
  moving += other.moving;
  explained += other.explained;
}

double RenderScore::value() const {
  const double fit = share(agreeing, predicted) - share(seen_through, predicted);
  return moving > 0 ? 0.5 * (fit + share(explained, moving)) : fit;
}

std::vector<RenderScore> render_scores(std::span<const RegistrationView> views,
                                       std::span<const MovingPoints> moving, const CameraModel& camera,
                                       std::span<const Pose> poses_base_sensor,
                                       const RenderScoreSettings& settings) {
  std::vector<std::vector<RenderScore>> by_view(views.size());
  // In parallel over views, never over poses: a virtual cell serves one thread at a time.
  tbb::parallel_for(std::size_t{0}, views.size(), [&](std::size_t v) {
    const PixelMask unknown;
    const PixelMask& mask = moving.empty() ? unknown : moving[v].mask;
    for (const Pose& T_base_sensor : poses_base_sensor)
      by_view[v].push_back(score_of(views[v], mask, camera, T_base_sensor, settings));
  });
  std::vector<RenderScore> scores(poses_base_sensor.size());
  for (const auto& of_view : by_view)
    for (std::size_t i = 0; i < scores.size(); ++i) scores[i].merge(of_view[i]);
  return scores;
}

}  // namespace calibrd
