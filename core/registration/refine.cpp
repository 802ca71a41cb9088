// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/refine.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/registration/covariance.hpp"

namespace calibrd {
namespace {

/// One stage of the annealing: kernels and freedoms.
struct Stage {
  int iterations;
  int stride;
  double range_kernel_m;   // 0: from the noise found
  double contour_search_px;  // 0: no contours yet
  bool free_bias;
};

constexpr double kKernelSigmas = 4.7;  // Tukey's biweight: 95 % efficient on normal noise
constexpr double kMinKernel_m = 0.006;

struct Sums {
  NormalEquations range, contour;
  RangeTally range_tally;
  ContourTally contour_tally;
};

/// Robust standard deviation of values that scatter about 0.
double robust_sigma(std::vector<float> values) {
  if (values.empty()) return 1;
  for (float& value : values) value = std::abs(value);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return 1.4826 * static_cast<double>(*middle);
}

class Refiner {
 public:
  Refiner(std::span<RegistrationView> views, const CameraModel& camera, const Pose& start, const RefineSettings& settings)
      : views_(views), camera_(camera), settings_(settings), predictions_(views.size()) {
    result_.T_base_sensor = start;
  }

  Refinement run() {
    const Stage stages[] = {{6, 2, 0.06, 0, false}, {5, 2, 0.03, 10, true}, {5, 1, 0, 6, true}};
    const Stage last{settings_.final_iterations, 1, 0, 4, true};
    double progress = 0;
    for (const Stage& stage : stages) {
      for (int i = 0; i < stage.iterations && !small_step_; ++i) step(stage);
      small_step_ = false;
      progress += 0.25;
      if (settings_.keep_going && !settings_.keep_going(progress)) return result_;
    }
    for (int i = 0; i < last.iterations && !small_step_; ++i) step(last);
    result_.converged = small_step_;
    finish(last);
    return result_;
  }

 private:
  Sums collect(const Stage& stage) {
    const RangeSettings range = range_settings(stage);
    ContourSettings contour;
    contour.search_px = contour.kernel_px = stage.contour_search_px;
    contour.stride = stage.stride;
    std::vector<Sums> per_view(views_.size());
    tbb::parallel_for(std::size_t{0}, views_.size(), [&](std::size_t v) {
      views_[v].cell.measure(camera_, result_.T_base_sensor, predictions_[v]);
      Sums& s = per_view[v];
      add_range_residuals(views_[v], predictions_[v], camera_, result_.T_base_sensor, result_.correction, range, s.range,
                          s.range_tally);
      if (stage.contour_search_px > 0)
        add_contour_residuals(views_[v], predictions_[v], camera_, result_.T_base_sensor, contour, s.contour,
                              s.contour_tally);
    });
    Sums total;
    for (const Sums& s : per_view) {
      total.range.merge(s.range);
      total.contour.merge(s.contour);
      total.range_tally.merge(s.range_tally);
      total.contour_tally.merge(s.contour_tally);
    }
    return total;
  }

  RangeSettings range_settings(const Stage& stage) const {
    RangeSettings range;
    range.stride = stage.stride;
    range.sigma_factor = result_.sigma_factor;
    const double noise_m = result_.sigma_factor * 1.6e-3;
    range.kernel_m = stage.range_kernel_m > 0 ? stage.range_kernel_m : std::clamp(kKernelSigmas * noise_m, kMinKernel_m, 0.04);
    return range;
  }

  /// Weighs range and contour by what their own scatter says they are worth.
  NormalEquations weighed(const Sums& sums, bool scatter_is_noise) {
    const double range_scale = robust_sigma(sums.range_tally.whitened);
    const double contour_scale = std::max(1.0, robust_sigma(sums.contour_tally.whitened));
    if (scatter_is_noise) {
      result_.sigma_factor = std::clamp(result_.sigma_factor * range_scale, 0.3, 20.0);
      result_.range_correlation = sums.range.correlation_factor();
      result_.contour_correlation = sums.contour.correlation_factor();
    }
    NormalEquations all = sums.range.scaled(1 / (range_scale * range_scale * result_.range_correlation));
    all.merge(sums.contour.scaled(1 / (contour_scale * contour_scale * result_.contour_correlation)));
    return all;
  }

  ParameterMatrix with_priors(const NormalEquations& all, bool free_bias, ParameterVector& gradient) const {
    ParameterMatrix information = all.information().selfadjointView<Eigen::Lower>();
    const double offset_sigma = free_bias ? settings_.offset_prior_m : 1e-6;
    const double scale_sigma = free_bias ? settings_.scale_prior : 1e-6;
    information(kOffset, kOffset) += 1 / (offset_sigma * offset_sigma);
    information(kScale, kScale) += 1 / (scale_sigma * scale_sigma);
    gradient = all.gradient();
    gradient[kOffset] -= result_.correction.offset_m / (offset_sigma * offset_sigma);
    gradient[kScale] -= (result_.correction.scale - 1) / (scale_sigma * scale_sigma);
    // A faint hold keeps the solution finite in directions that nothing pins; the covariance leaves it out.
    information.diagonal().head<6>().array() += 1e-9 * information.diagonal().head<6>().maxCoeff();
    return information;
  }

  void step(const Stage& stage) {
    const Sums sums = collect(stage);
    const NormalEquations all = weighed(sums, stage.range_kernel_m == 0);
    if (all.count() < 50) return;
    ParameterVector gradient;
    const ParameterMatrix information = with_priors(all, stage.free_bias, gradient);
    const ParameterVector delta = information.ldlt().solve(gradient);
    result_.T_base_sensor = perturbed(result_.T_base_sensor, delta.head<6>());
    result_.correction.offset_m += delta[kOffset];
    result_.correction.scale += delta[kScale];
    small_step_ = delta.dot(information * delta) < settings_.convergence_sigmas * settings_.convergence_sigmas;
  }

  void finish(const Stage& stage) {
    Sums sums = collect(stage);
    const NormalEquations all = weighed(sums, true);
    ParameterVector gradient;
    const ParameterMatrix information = with_priors(all, true, gradient);
    result_.covariance = pose_covariance(information, all);
    result_.residual_rms_m = sums.range.rms_residual();
    const Matrix6d pose_information = information.topLeftCorner<6, 6>();
    result_.weakest_eigenvalue = Eigen::SelfAdjointEigenSolver<Matrix6d>(pose_information).eigenvalues()[0];
    result_.range = std::move(sums.range_tally);
    result_.contour = std::move(sums.contour_tally);
  }

  std::span<RegistrationView> views_;
  const CameraModel& camera_;
  const RefineSettings& settings_;
  std::vector<VirtualMeasurement> predictions_;
  Refinement result_;
  bool small_step_ = false;
};

}  // namespace

Refinement refine(std::span<RegistrationView> views, const CameraModel& camera, const Pose& start,
                  const RefineSettings& settings) {
  return Refiner(views, camera, start, settings).run();
}

}  // namespace calibrd
