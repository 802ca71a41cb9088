// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "core/registration/registration_view.hpp"

namespace calibrd {
namespace {

std::vector<float> to_metres(const DepthImage& depth) {
  std::vector<float> metres(depth.raw.size());
  const auto scale = static_cast<float>(depth.scale_m);
  std::ranges::transform(depth.raw, metres.begin(),
                         [scale](std::uint16_t raw) { return scale * static_cast<float>(raw); });
  return metres;
}

/// Drops pixels beside a depth step: a time-of-flight or stereo pixel there mixes two surfaces.
std::vector<float> without_mixed_pixels(const std::vector<float>& depth, int width, int height, float step) {
  std::vector<float> clean(depth.size(), 0.0F);
  for (int y = 1; y + 1 < height; ++y) {
    for (int x = 1; x + 1 < width; ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
      const float z = depth[i];
      if (z <= 0) continue;
      const auto row = static_cast<std::size_t>(width);
      const auto close = [&](float neighbour) { return neighbour > 0 && std::abs(neighbour - z) < step * z; };
      if (close(depth[i - 1]) && close(depth[i + 1]) && close(depth[i - row]) && close(depth[i + row]))
        clean[i] = z;
    }
  }
  return clean;
}

/// Binomial smoothing (1 2 1) in both directions: enough to take single-pixel noise out of gradients.
std::vector<float> smoothed(const GreyImage& image) {
  const int w = image.width, h = image.height;
  const auto at = [w](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x);
  };
  std::vector<float> rows(image.pixels.size()), out(image.pixels.size());
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const int left = std::max(x - 1, 0), right = std::min(x + 1, w - 1);
      rows[at(x, y)] = 0.25F * static_cast<float>(image.pixels[at(left, y)] + 2 * image.pixels[at(x, y)] +
                                                  image.pixels[at(right, y)]);
    }
  }
  for (int y = 0; y < h; ++y) {
    const int up = std::max(y - 1, 0), down = std::min(y + 1, h - 1);
    for (int x = 0; x < w; ++x)
      out[at(x, y)] = 0.25F * (rows[at(x, up)] + 2 * rows[at(x, y)] + rows[at(x, down)]);
  }
  return out;
}

/// Robust spread of horizontal differences: most of an image is not an edge.
double difference_noise(const std::vector<float>& image) {
  std::vector<float> steps;
  steps.reserve(image.size() / 7 + 1);
  for (std::size_t i = 1; i < image.size(); i += 7) steps.push_back(std::abs(image[i] - image[i - 1]));
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
  const auto rays = std::make_shared<const PixelRays>(camera);
  for (const View& view : views) {
    VirtualCell posed = cell;
    posed.set_joints(view.joint_positions_rad);
    JointAxes axes(cell.robot(), posed.link_poses());
    RegistrationView ready{std::move(posed), view.joint_positions_rad, std::move(axes), {}, {}, 0, rays};
    ready.depth_m = without_mixed_pixels(to_metres(view.depth), camera.width, camera.height,
                                         static_cast<float>(settings.mixed_step));
    if (settings.use_images && view.image) {
      ready.image = smoothed(*view.image);
      ready.image_noise = difference_noise(ready.image);
    }
    prepared.push_back(std::move(ready));
  }
  return prepared;
}

}  // namespace calibrd
