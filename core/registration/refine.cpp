// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/refine.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/registration/covariance.hpp"
#include "core/registration/range_period.hpp"
#include "core/registration/repeated_postures.hpp"
#include "core/registration/reported_joints.hpp"
#include "core/registration/view_sums.hpp"

namespace calibrd {
namespace {

/// One stage of the annealing: kernels and freedoms.
struct Stage {
  int iterations;
  int stride;                // of pixels in both directions, and of contour pixels along the contour
  double range_kernel_m;     // 0: from the noise found
  double contour_search_px;  // 0: no contours yet
  bool fit_profile;          // fit modelled light profiles to the contours rather than find the steepest step
  bool free_bias;
  bool free_zeros;
};

constexpr double kKernelSigmas = 4.7;  // Tukey's biweight: 95 % efficient on normal noise
constexpr double kMinKernel_m = 0.006;
constexpr int kFullSteps = 5;
/// Depth edges are found to half a pixel: most of them may agree to nothing, which says nothing of their
/// errors.
constexpr double kMinEdgeScatter = 0.5;
/// Chance lets the cost fall by as much through seven joint zeros once in twenty times. Zeros of a robot that
/// has none would only carry noise into the pose.
constexpr double kSignificantFall = 14;
/// What the model leaves out (shading, mesh errors, the robust kernels' choice of pixels) made errors on
/// simulated captures this much larger, squared, than the scatter of residuals alone says.
constexpr double kModelAllowance = 1.55;

/// What the scatter of one kind of edges showed so far.
struct EdgeNoise {
  double sigma_px = 0.5;
  double correlation = 1;  // times that errors are less independent than their number says
};

class Refiner {
 public:
  Refiner(std::span<RegistrationView> views, const CameraModel& camera, const Pose& start,
          const RefineSettings& settings)
      : views_(views), camera_(camera), settings_(settings), predictions_(views.size()) {
    result_.T_base_sensor = start;
  }

  Refinement run() {
    const Stage stages[] = {{4, 3, 0.06, 0, false, false, false},
                            {4, 3, 0.03, 10, false, true, false},
                            {3, 2, 0, 5, false, true, false}};
    const bool zeros = settings_.joint_zero_prior > 0;
    Stage closing{settings_.final_iterations, 2, 0, 3, true, true, zeros};
    Stage last{5, 1, 0, 3, true, true, zeros};
    const Stage judged = last;  // what is known is known with the zeros free, whether they are used or not
    double progress = 0;
    for (const Stage& stage : stages) {
      run_stage(stage);
      progress += 0.25;
      if (settings_.keep_going && !settings_.keep_going(progress)) return result_;
    }
    step(closing, 0);
    choose_period(closing);
    run_stage(closing);
    if (zeros && fall_by_joint_zeros(last_information_, result_.joint_zeros) < kSignificantFall) {
      closing.free_zeros = last.free_zeros = false;
      set_zeros(JointZeros::Zero());
      run_stage(closing);
    }
    run_stage(last);
    finish(judged);
    return result_;
  }

 private:
  void run_stage(const Stage& stage) {
    small_step_ = false;
    for (int i = 0; i < stage.iterations && !small_step_; ++i) step(stage, i);
  }

  ViewSums collect(const Stage& stage, bool keep_samples = false) {
    ViewSumSettings settings;
    settings.range = range_settings(stage);
    for (std::size_t k = 0; k < kEdgeSources.size(); ++k)
      settings.contour[k] = contour_settings(stage, kEdgeSources[k]);
    settings.contour_stride = stage.contour_search_px > 0 ? stage.stride + 2 : 0;
    settings.keep_samples = keep_samples;
    return sum_views(views_, predictions_, camera_, result_.T_base_sensor, result_.correction, settings);
  }

  ContourSettings contour_settings(const Stage& stage, EdgeSource source) const {
    ContourSettings contour;
    contour.source = source;
    const bool used = source == EdgeSource::image || settings_.use_depth_outline;
    contour.search_px = contour.kernel_px = used ? stage.contour_search_px : 0;
    // Once profiles are fitted, what lies several sigmas away is another edge.
    const double sigma_px = edge_noise_[static_cast<std::size_t>(source)].sigma_px;
    if (stage.fit_profile)
      contour.kernel_px = std::clamp(kKernelSigmas * sigma_px, 0.7, stage.contour_search_px);
    contour.fit_profile = stage.fit_profile;
    contour.shift_px = source == EdgeSource::image ? result_.image_shift_px : result_.depth_shift_px;
    return contour;
  }

  RangeSettings range_settings(const Stage& stage) const {
    RangeSettings range;
    range.stride = stage.stride;
    range.sigma_factor = result_.sigma_factor;
    const double noise_m = result_.sigma_factor * 1.6e-3;
    range.kernel_m = stage.range_kernel_m > 0 ? stage.range_kernel_m
                                              : std::clamp(kKernelSigmas * noise_m, kMinKernel_m, 0.04);
    return range;
  }

  /// Weighs range and contour by what their own scatter says they are worth.
  NormalEquations weighed(const ViewSums& sums, bool scatter_is_noise) {
    if (scatter_is_noise) {
      result_.range_correlation = sums.range.correlation_factor();
    }
    for (std::size_t k = 0; k < kEdgeSources.size(); ++k) {
      const ContourSums& edges = sums.contour[k];
      if (scatter_is_noise) edge_noise_[k].correlation = edges.equations.correlation_factor();
      if (!edges.tally.residuals_px.empty()) edge_noise_[k].sigma_px = robust_sigma(edges.tally.residuals_px);
    }
    NormalEquations all = sums.range.scaled(range_weight(sums));
    all.merge(contour_part(sums));
    if (scatter_is_noise)
      result_.sigma_factor =
          std::clamp(result_.sigma_factor * robust_sigma(sums.range_tally.whitened), 0.3, 20.0);
    return all;
  }

  double range_weight(const ViewSums& sums) const {
    const double scale = robust_sigma(sums.range_tally.whitened);
    return 1 / (scale * scale * result_.range_correlation);
  }

  NormalEquations contour_part(const ViewSums& sums) const {
    NormalEquations all;
    for (std::size_t k = 0; k < kEdgeSources.size(); ++k) {
      const double scale = std::max(robust_sigma(sums.contour[k].tally.whitened), kMinEdgeScatter);
      all.merge(sums.contour[k].equations.scaled(1 / (scale * scale * edge_noise_[k].correlation)));
    }
    return all;
  }

  /// Everything known before the views were seen, as one observation per parameter.
  void add_priors(const Stage& stage, ParameterMatrix& information, ParameterVector& gradient) const {
    constexpr double kHeld = 1e-7;
    const auto add = [&](Parameter parameter, double value, double sigma) {
      information(parameter, parameter) += 1 / (sigma * sigma);
      gradient[parameter] -= value / (sigma * sigma);
    };
    const DepthCorrection& c = result_.correction;
    const bool periodic = c.periodic_period_m > 0;
    add(kOffset, c.offset_m, stage.free_bias ? settings_.offset_prior_m : kHeld);
    add(kScale, c.scale - 1, stage.free_bias ? settings_.scale_prior : kHeld);
    add(kSine, c.periodic_sin_m, settings_.periodic_prior_m);
    add(kCosine, c.periodic_cos_m, settings_.periodic_prior_m);
    add(kPeriod, periodic ? c.periodic_period_m - period_start_m_ : 0, settings_.period_prior_m);
    add(kImageShift, result_.image_shift_px, settings_.image_shift_prior_px);
    add(kDepthShift, result_.depth_shift_px, settings_.depth_shift_prior_px);
    const double zero_sigma = stage.free_zeros ? settings_.joint_zero_prior : kHeld;
    for (int j = 0; j < kMaxJointZeros; ++j)
      add(static_cast<Parameter>(kJointZeros + j), result_.joint_zeros[j], zero_sigma);
    // A faint hold keeps the solution finite in directions that nothing pins.
    information.diagonal().head<6>().array() += 1e-9 * information.diagonal().head<6>().maxCoeff();
  }

  ParameterMatrix with_priors(const NormalEquations& all, const Stage& stage,
                              ParameterVector& gradient) const {
    ParameterMatrix information = all.information().selfadjointView<Eigen::Lower>();
    gradient = all.gradient();
    add_priors(stage, information, gradient);
    return information;
  }

  void choose_period(const Stage& stage) {
    const ViewSums sums = collect(stage, true);
    weighed(sums, true);
    ParameterMatrix information = contour_part(sums).information();
    ParameterVector gradient = contour_part(sums).gradient();
    add_priors(stage, information, gradient);
    if (const auto term = find_period(sums.samples, range_weight(sums), information, gradient)) {
      result_.correction.periodic_period_m = period_start_m_ = term->period_m;
      result_.correction.periodic_sin_m = term->sin_m;
      result_.correction.periodic_cos_m = term->cos_m;
    }
  }

  void step(const Stage& stage, int iteration) {
    const ViewSums sums = collect(stage);
    const NormalEquations all = weighed(sums, stage.range_kernel_m == 0);
    if (all.count() < 50) return;
    ParameterVector gradient;
    const ParameterMatrix information = with_priors(all, stage, gradient);
    // Image edges and pixels change sides between steps; halved steps settle that jitter.
    const double pace = iteration < kFullSteps ? 1.0 : 0.5;
    const Eigen::LDLT<ParameterMatrix> solver(information);
    const ParameterVector full_step = solver.solve(gradient);
    const ParameterVector delta = pace * full_step;
    note_step(full_step.head<6>(), solver);
    result_.T_base_sensor = perturbed(result_.T_base_sensor, delta.head<6>());
    DepthCorrection& c = result_.correction;
    c.offset_m += delta[kOffset];
    c.scale += delta[kScale];
    if (c.periodic_period_m > 0) {
      c.periodic_sin_m += delta[kSine];
      c.periodic_cos_m += delta[kCosine];
      c.periodic_period_m = std::max(0.2, c.periodic_period_m + delta[kPeriod]);
    }
    result_.image_shift_px += delta[kImageShift];
    result_.depth_shift_px += delta[kDepthShift];
    if (stage.free_zeros) set_zeros(result_.joint_zeros + delta.tail<kMaxJointZeros>());
    last_information_ = information;
    small_step_ = std::sqrt(delta.dot(information * delta)) < settings_.convergence_sigmas;
  }

  void set_zeros(const JointZeros& zeros) {
    result_.joint_zeros = zeros;
    for (RegistrationView& view : views_) view.apply_zeros(zeros);
  }

  /// How far the pose still drifts: the mean of the last steps, whole ones, in its own standard deviations.
  /// Pixels that change sides make single steps jitter; what has not settled keeps its direction.
  void note_step(const Vector6d& pose_step, const Eigen::LDLT<ParameterMatrix>& information) {
    constexpr std::size_t kRemembered = 2;
    last_steps_.push_back(pose_step);
    if (last_steps_.size() > kRemembered) last_steps_.erase(last_steps_.begin());
    Vector6d mean = Vector6d::Zero();
    for (const Vector6d& step : last_steps_) mean += step / static_cast<double>(last_steps_.size());
    const ParameterMatrix covariance = information.solve(ParameterMatrix::Identity());
    const Matrix6d of_pose = covariance.topLeftCorner<6, 6>();
    result_.last_step_sigmas = std::sqrt(mean.dot(of_pose.ldlt().solve(mean)) / 6);
  }

  void finish(const Stage& stage) {
    ViewSums sums = collect(stage);
    const NormalEquations all = weighed(sums, true);
    ParameterVector gradient;
    const ParameterMatrix information = with_priors(all, stage, gradient);
    publish_for_reported_joints(parameter_covariance(information, all));
    result_.residual_rms_m = sums.range.rms_residual();
    const Matrix6d pose_information = information.topLeftCorner<6, 6>();
    result_.weakest_eigenvalue = Eigen::SelfAdjointEigenSolver<Matrix6d>(pose_information).eigenvalues()[0];
    result_.range = std::move(sums.range_tally);
    result_.contour = std::move(sums.contour[0].tally);
    result_.depth_contour = std::move(sums.contour[1].tally);
  }

  /// From the pose of the true base to the pose that is right for the joints as reported.
  void publish_for_reported_joints(const ParameterMatrix& covariance) {
    Eigen::Matrix<double, 6, kParameters> published = Eigen::Matrix<double, 6, kParameters>::Zero();
    published.leftCols<6>().setIdentity();
    published.rightCols<kMaxJointZeros>() =
        reported_joints_map(views_, predictions_, camera_, result_.T_base_sensor);
    result_.covariance =
        kModelAllowance * views_per_posture(views_) * published * covariance * published.transpose();
    result_.joint_zero_sigmas = covariance.diagonal().tail<kMaxJointZeros>().cwiseSqrt();
    result_.T_base_sensor =
        perturbed(result_.T_base_sensor, published.rightCols<kMaxJointZeros>() * result_.joint_zeros);
  }

  std::span<RegistrationView> views_;
  const CameraModel& camera_;
  const RefineSettings& settings_;
  std::vector<VirtualMeasurement> predictions_;
  Refinement result_;
  std::vector<Vector6d> last_steps_;
  ParameterMatrix last_information_ = ParameterMatrix::Zero();
  double period_start_m_ = 0;
  std::array<EdgeNoise, 2> edge_noise_;  // by EdgeSource
  bool small_step_ = false;
};

}  // namespace

Refinement refine(std::span<RegistrationView> views, const CameraModel& camera, const Pose& start,
                  const RefineSettings& settings) {
  return Refiner(views, camera, start, settings).run();
}

}  // namespace calibrd
