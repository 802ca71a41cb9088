// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/track.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/registration/depth_noise.hpp"
#include "core/registration/frame_pixels.hpp"
#include "core/registration/linearization.hpp"

namespace calibrd {
namespace {

constexpr int kParametersHere = 7;  // perturbed()'s δ, and the change of the range offset
using Parameters = Eigen::Matrix<double, kParametersHere, 1>;
using Information = Eigen::Matrix<double, kParametersHere, kParametersHere>;

constexpr double kKernelSigmas = 4.7;  // Tukey's biweight: 95 % efficient on normal noise
constexpr double kMinKernel_m = 0.006;
constexpr double kTypicalSigma_m = 1.6e-3;
/// Pixels on a block of this side (pixels of the sensor) share a cluster: their errors correlate.
constexpr int kBlockSide = 24;

CameraModel thinned(const CameraModel& camera, int stride) {
  CameraModel sparse = camera;  // its pixel (u, v) is the camera's (stride u + stride/2, stride v + stride/2)
  const int first = stride / 2;
  sparse.width = (camera.width - first + stride - 1) / stride;
  sparse.height = (camera.height - first + stride - 1) / stride;
  sparse.fx = camera.fx / stride;
  sparse.fy = camera.fy / stride;
  sparse.cx = (camera.cx - first) / stride;
  sparse.cy = (camera.cy - first) / stride;
  return sparse;
}

}  // namespace

/// Gauss-Newton sums over the pixels of some rows.
struct PoseTracker::Sums {
  Information information = Information::Zero();
  Parameters gradient = Parameters::Zero();
  double cluster_squares = 0;  // Σ over clusters (Σ w r/σ)²
  double squares = 0;          // Σ (w r/σ)²
  std::size_t measured = 0, agreeing = 0;
  std::vector<float> whitened;
  std::vector<double> clusters;  // of the block row at hand

  void add(const Parameters& jacobian, double residual, double sigma, double robust_weight,
           std::size_t cluster) {
    const double weight = robust_weight / (sigma * sigma);
    information.selfadjointView<Eigen::Lower>().rankUpdate(jacobian, weight);
    gradient += weight * residual * jacobian;
    const double pull = robust_weight * residual / sigma;
    clusters[cluster] += pull;
    squares += pull * pull;
    whitened.push_back(static_cast<float>(residual / sigma));
    ++agreeing;
  }
  void close_clusters() {
    for (const double cluster : clusters) cluster_squares += cluster * cluster;
  }
  void merge(const Sums& other) {
    information += other.information;
    gradient += other.gradient;
    cluster_squares += other.cluster_squares;
    squares += other.squares;
    measured += other.measured;
    agreeing += other.agreeing;
    whitened.insert(whitened.end(), other.whitened.begin(), other.whitened.end());
  }
};

PoseTracker::PoseTracker(const VirtualCell& cell, const CameraModel& camera, const TrackSettings& settings)
    : settings_(settings), camera_(camera), sparse_camera_(thinned(camera, settings.stride)), cell_(cell) {
  for (int v = 0; v < sparse_camera_.height; ++v)
    for (int u = 0; u < sparse_camera_.width; ++u) rays_.push_back(sparse_camera_.ray(u, v));
}

Status PoseTracker::check(const View& view) const {
  const auto pixels = static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height);
  if (view.depth.width != camera_.width || view.depth.height != camera_.height ||
      view.depth.raw.size() != pixels)
    return fail(TrackError::wrong_image_size,
                std::to_string(view.depth.width) + " x " + std::to_string(view.depth.height));
  if (view.joint_positions_rad.size() != cell_.robot().position_count())
    return fail(TrackError::wrong_joints, std::to_string(view.joint_positions_rad.size()) + " positions");
  if (!std::ranges::all_of(view.joint_positions_rad, [](double q) { return std::isfinite(q); }))
    return fail(TrackError::wrong_joints, "a position is not a finite number");
  return Done{};
}

void PoseTracker::compare_row(int row, const View& view, const Pose& T_base_sensor,
                              const DepthCorrection& correction, const Weighing& weighing, Sums& sums) const {
  const Eigen::Matrix3d R = T_base_sensor.linear();
  for (int column = 0; column < sparse_camera_.width; ++column) {
    const auto i = static_cast<std::size_t>(row * sparse_camera_.width + column);
    if (prediction_.link[i] < 0) continue;
    const double z = prediction_.depth_m[i];
    const Eigen::Vector3d d = rays_[i], n = prediction_.normal[i].cast<double>();
    const double slope = n.dot(d);  // below 0: normals face the sensor
    const double cos_incidence = -slope / d.norm();
    if (cos_incidence < settings_.min_cos_incidence || is_rim(prediction_, rays_, column, row)) continue;
    const double measured = measured_m(view.depth, settings_.stride * column + settings_.stride / 2,
                                       settings_.stride * row + settings_.stride / 2);
    if (measured <= 0) continue;
    ++sums.measured;
    const double residual = measured - correction.measured(z), off = residual / weighing.kernel_m;
    if (std::abs(off) >= 1) continue;
    // The sensor moves by δ, the surface stands: the depth changes by -(u×n·δω + n·δt)/(n·d).
    const Eigen::Vector3d n_base = R * n, u_base = R * (z * d);
    const double factor = -correction.slope(z) / slope;
    Parameters jacobian;
    jacobian << factor * u_base.cross(n_base), factor * n_base, 1;
    sums.add(jacobian, residual, weighing.sigma_factor * depth_sigma_m(z, cos_incidence, 1 / camera_.fx),
             (1 - off * off) * (1 - off * off),
             static_cast<std::size_t>(column * settings_.stride / kBlockSide));
  }
}

PoseTracker::Sums PoseTracker::collect(const View& view, const Pose& T_base_sensor,
                                       const DepthCorrection& correction, const Weighing& weighing) {
  cell_.measure(sparse_camera_, T_base_sensor, prediction_);
  const int rows_per_block = std::max(1, kBlockSide / settings_.stride);
  std::vector<Sums> blocks(static_cast<std::size_t>((sparse_camera_.height - 1) / rows_per_block + 1));
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    Sums& sums = blocks[b];
    sums.clusters.assign(static_cast<std::size_t>(camera_.width / kBlockSide + 1), 0.0);
    const int first = static_cast<int>(b) * rows_per_block;
    for (int row = first; row < std::min(first + rows_per_block, sparse_camera_.height); ++row)
      compare_row(row, view, T_base_sensor, correction, weighing, sums);
    sums.close_clusters();
  });
  Sums total;
  for (const Sums& sums : blocks) total.merge(sums);
  total.information = total.information.selfadjointView<Eigen::Lower>();
  return total;
}

/// One Gauss-Newton step; false where the pixels leave a direction open.
bool PoseTracker::step(const Sums& sums, double scatter, TrackedPose& tracked) const {
  const double correlation = std::max(1.0, sums.cluster_squares / sums.squares);
  const double worth = 1 / (scatter * scatter * correlation);
  const double prior = 1 / (settings_.offset_prior_m * settings_.offset_prior_m);
  Information information = worth * sums.information;
  Parameters gradient = worth * sums.gradient;
  information(6, 6) += prior;
  gradient[6] -= prior * tracked.offset_change_m;
  const Eigen::LDLT<Information> solver(information);
  constexpr double kLeastPivot = 1e-9;  // of the largest; what a flat face leaves open lies far below
  if (!(solver.vectorD().minCoeff() > kLeastPivot * solver.vectorD().maxCoeff())) return false;
  const Parameters delta = solver.solve(gradient);
  tracked.T_base_sensor = perturbed(tracked.T_base_sensor, delta.head<6>());
  tracked.offset_change_m += delta[6];
  tracked.last_step_sigmas = std::sqrt(delta.dot(information * delta));
  tracked.covariance = solver.solve(Information::Identity()).topLeftCorner<6, 6>();
  return true;
}

Result<TrackedPose> PoseTracker::update(const View& view, const Pose& T_base_sensor,
                                        const DepthCorrection& correction) {
  if (auto usable = check(view); !usable) return usable.error();
  cell_.set_joints(view.joint_positions_rad);
  TrackedPose tracked;
  tracked.T_base_sensor = T_base_sensor;
  DepthCorrection corrected = correction;
  Weighing weighing{settings_.first_kernel_m, 1};
  for (int i = 0; i < settings_.steps; ++i) {
    Sums sums = collect(view, tracked.T_base_sensor, corrected, weighing);
    tracked.measured = sums.measured;
    tracked.agreeing = sums.agreeing;
    if (sums.agreeing < settings_.min_pixels)
      return fail(TrackError::too_few_pixels, std::to_string(sums.agreeing) + " agree");
    const double scatter = robust_sigma(std::move(sums.whitened));
    if (!step(sums, scatter, tracked)) return fail(TrackError::unobservable, "");
    corrected.offset_m = correction.offset_m + tracked.offset_change_m;
    weighing.sigma_factor = std::clamp(weighing.sigma_factor * scatter, 0.3, 20.0);
    weighing.kernel_m = std::clamp(kKernelSigmas * weighing.sigma_factor * kTypicalSigma_m, kMinKernel_m,
                                   settings_.first_kernel_m);
  }
  tracked.sigma_factor = weighing.sigma_factor;
  tracked.innovation = difference(T_base_sensor, tracked.T_base_sensor);
  return tracked;
}

}  // namespace calibrd
