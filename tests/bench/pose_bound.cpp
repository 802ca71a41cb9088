// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/pose_bound.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/virtual_cell/virtual_cell.hpp"
#include "drivers/sim/render/depth_model.hpp"

namespace calibrd::bench {
namespace {

constexpr double kStep = 2e-4;          // rad and m: 0.07 pixels, yet far above what a float's depth rounds
constexpr float kEdge_m = 0.03F;        // between neighbouring pixels; a surface seen at 80 deg stays below
constexpr float kBend_m = 2e-4F;        // between the three renderings: a step was crossed
constexpr double kWholeMm_m = 1e-3;     // depth is rounded to this
constexpr double kWorstSigma_m = 0.05;  // the simulator's own limit

using Row = Eigen::Matrix<double, 8, 1>;  // pose, range offset, range scale
using Information = Eigen::Matrix<double, 8, 8>;

/// One view from the true pose and from a step to either side of it along each of the six.
struct Renderings {
  VirtualMeasurement middle;
  std::array<VirtualMeasurement, 6> plus, minus;
};

void render(const Scene& scene, std::size_t view, VirtualCell& cell, Renderings& images) {
  const Pose& T = scene.truth.T_base_sensor;
  cell.set_joints(scene.true_joints_rad(view));
  cell.measure(scene.camera, T, images.middle);
  for (std::size_t i = 0; i < 6; ++i) {
    const Vector6d step = kStep * Vector6d::Unit(static_cast<Eigen::Index>(i));
    cell.measure(scene.camera, perturbed(T, step), images.plus[i]);
    cell.measure(scene.camera, perturbed(T, -step), images.minus[i]);
  }
}

bool is_inside_surface(const VirtualMeasurement& image, int x, int y) {
  if (x < 1 || y < 1 || x + 1 >= image.width || y + 1 >= image.height) return false;
  const int i = y * image.width + x;
  const float depth = image.depth_m[static_cast<std::size_t>(i)];
  return depth > 0 &&
         std::ranges::all_of(std::array{i - 1, i + 1, i - image.width, i + image.width}, [&](int n) {
           const float other = image.depth_m[static_cast<std::size_t>(n)];
           return other > 0 && std::abs(other - depth) < kEdge_m;
         });
}

/// Derivatives of one pixel's depth; false where a step of the surface passes through it.
bool differentiate(const Renderings& images, std::size_t pixel, Row& row) {
  const float depth = images.middle.depth_m[pixel];
  for (std::size_t i = 0; i < 6; ++i) {
    const float ahead = images.plus[i].depth_m[pixel], behind = images.minus[i].depth_m[pixel];
    if (ahead <= 0 || behind <= 0 || std::abs(ahead + behind - 2 * depth) > kBend_m) return false;
    row[static_cast<Eigen::Index>(i)] = static_cast<double>(ahead - behind) / (2 * kStep);
  }
  row[6] = 1;
  row[7] = depth;
  return true;
}

double variance_m2(const Scene& scene, const VirtualMeasurement& image, int x, int y) {
  const auto i = static_cast<std::size_t>(y * image.width + x);
  const Eigen::Vector3d ray = scene.camera.ray(x, y).normalized();
  const double cosine = std::clamp(-image.normal[i].cast<double>().dot(ray), 0.0, 1.0);
  const double sigma = scene.truth.depth_errors.noise *
                       std::min(kWorstSigma_m, sim::axial_noise_m(image.depth_m[i], std::acos(cosine)));
  return sigma * sigma + kWholeMm_m * kWholeMm_m / 12;
}

template <int N>
PoseBound bound_of(const Eigen::Matrix<double, N, N>& information) {
  const Matrix6d covariance = information.inverse().template topLeftCorner<6, 6>();
  return {std::sqrt(covariance.template bottomRightCorner<3, 3>().trace()),
          std::sqrt(covariance.template topLeftCorner<3, 3>().trace())};
}

}  // namespace

PoseBounds pose_bounds(const Scene& scene, std::size_t views) {
  VirtualCell cell(scene.robot->model);
  Renderings images;
  Information information = Information::Zero();
  PoseBounds bounds;
  for (std::size_t view = 0; view < views; ++view) {
    render(scene, view, cell, images);
    for (int y = 0; y < images.middle.height; ++y)
      for (int x = 0; x < images.middle.width; ++x) {
        Row row;
        const auto pixel = static_cast<std::size_t>(y * images.middle.width + x);
        if (!is_inside_surface(images.middle, x, y) || !differentiate(images, pixel, row)) continue;
        information += row * row.transpose() / variance_m2(scene, images.middle, x, y);
        ++bounds.pixels;
      }
  }
  bounds.range_known = bound_of<6>(information.topLeftCorner<6, 6>());
  information(6, 6) += 1 / (kOffsetPrior_m * kOffsetPrior_m);
  information(7, 7) += 1 / (kScalePrior * kScalePrior);
  bounds.range_free = bound_of<8>(information);
  return bounds;
}

}  // namespace calibrd::bench
