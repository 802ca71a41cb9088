// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/registration/registration_view.hpp"

namespace calibrd {
namespace {

/// Depth in metres, without the pixels beside a depth step: a time-of-flight or stereo pixel there mixes two
/// surfaces.
std::vector<float> without_mixed_pixels(const DepthImage& depth, float step) {
  const auto row = static_cast<std::size_t>(depth.width);
  const auto scale = static_cast<float>(depth.scale_m);
  std::vector<float> clean(depth.raw.size(), 0.0F);
  tbb::parallel_for(tbb::blocked_range<int>(1, std::max(1, depth.height - 1), 32), [&](const auto& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) {
      const std::uint16_t* at = depth.raw.data() + static_cast<std::size_t>(y) * row;
      float* out = clean.data() + static_cast<std::size_t>(y) * row;
      for (std::size_t x = 1; x + 1 < row; ++x) {
        const float z = at[x];
        const float reach = step * z;
        const auto is_close = [&](std::uint16_t neighbour) {
          return (neighbour > 0) & (std::abs(static_cast<float>(neighbour) - z) < reach);
        };
        const bool is_pure =
            is_close(at[x - 1]) & is_close(at[x + 1]) & is_close(*(at + x - row)) & is_close(at[x + row]);
        out[x] = is_pure ? scale * z : 0.0F;
      }
    }
  });
  return clean;
}

/// Weights 1 2 1 of three neighbours.
float binomial(float before, float here, float after) { return 0.25F * (before + 2 * here + after); }

/// Binomial smoothing (1 2 1) in both directions: enough to take single-pixel noise out of gradients.
std::vector<float> smoothed(const GreyImage& image) {
  const auto w = static_cast<std::size_t>(image.width), h = static_cast<std::size_t>(image.height);
  std::vector<float> rows(image.pixels.size()), out(image.pixels.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, h, 32), [&](const auto& range) {
    for (std::size_t y = range.begin(); y < range.end(); ++y) {
      const std::uint16_t* in = image.pixels.data() + y * w;
      float* row = rows.data() + y * w;
      row[0] = binomial(in[0], in[0], in[std::min<std::size_t>(1, w - 1)]);
      for (std::size_t x = 1; x + 1 < w; ++x) row[x] = binomial(in[x - 1], in[x], in[x + 1]);
      row[w - 1] = binomial(in[w - std::min<std::size_t>(2, w)], in[w - 1], in[w - 1]);
    }
  });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, h, 32), [&](const auto& range) {
    for (std::size_t y = range.begin(); y < range.end(); ++y) {
      const float* up = rows.data() + (y > 0 ? y - 1 : y) * w;
      const float* here = rows.data() + y * w;
      const float* down = rows.data() + std::min(y + 1, h - 1) * w;
      for (std::size_t x = 0; x < w; ++x) out[y * w + x] = binomial(up[x], here[x], down[x]);
    }
  });
  return out;
}

/// Robust spread of horizontal differences: most of an image is not an edge.
double difference_noise(const std::vector<float>& image) {
  std::vector<float> steps;
  constexpr std::size_t kStride = 23;
  steps.reserve(image.size() / kStride + 1);
  for (std::size_t i = 1; i < image.size(); i += kStride) steps.push_back(std::abs(image[i] - image[i - 1]));
  if (steps.empty()) return 0.1;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return std::max(1.4826 * static_cast<double>(*middle), 0.1);
}

}  // namespace

void RegistrationView::apply_zeros(const JointZeros& zeros) {
  std::vector<double> positions = reported_joints;
  for (std::size_t j = 0; j < positions.size() && j < kMaxJointZeros; ++j)
    positions[j] += zeros[static_cast<Eigen::Index>(j)];
  cell.set_joints(positions);
  axes = JointAxes(cell.robot(), cell.link_poses());
}

std::vector<RegistrationView> prepare_views(const VirtualCell& cell, const CameraModel& camera,
                                            std::span<const View> views, const PrepareSettings& settings) {
  std::vector<RegistrationView> prepared;
  prepared.reserve(views.size());
  const auto rays = cell.pixel_rays(camera);
  for (const View& view : views) {
    VirtualCell posed = cell;
    posed.set_joints(view.joint_positions_rad);
    JointAxes axes(cell.robot(), posed.link_poses());
    RegistrationView ready{std::move(posed), view.joint_positions_rad, std::move(axes), {}, {}, 0, rays};
    ready.depth_m = without_mixed_pixels(view.depth, static_cast<float>(settings.mixed_step));
    if (settings.use_images && view.image) {
      ready.image = smoothed(*view.image);
      ready.image_noise = difference_noise(ready.image);
    }
    prepared.push_back(std::move(ready));
  }
  return prepared;
}

}  // namespace calibrd
