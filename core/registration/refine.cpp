// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/refine.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/registration/covariance.hpp"
#include "core/registration/priors.hpp"
#include "core/registration/range_period.hpp"
#include "core/registration/repeated_postures.hpp"
#include "core/registration/reported_joints.hpp"
#include "core/registration/sensor_noise.hpp"

namespace calibrd {
namespace {

/// One stage of the annealing: kernels and freedoms.
struct Stage {
  int renderings;            // at most; each is good for kStepsPerRendering steps
  int stride;                // of pixels in both directions
  double range_kernel_m;     // 0: from the noise found
  double contour_search_px;  // 0: no contours yet
  bool fit_profile;          // fit modelled light profiles to the contours rather than find the steepest step
  bool free_bias;
  bool free_zeros;
};

constexpr double kKernelSigmas = 4.7;  // Tukey's biweight: 95 % efficient on normal noise
constexpr double kMinKernel_m = 0.006;
constexpr int kStepsPerRendering = 3;
constexpr double kSettled = 0.1;  // sigmas: a step so small is the last on one rendering
constexpr int kContourStride = 2, kFineContourStride = 3;
constexpr double kSamePlace_px = 0.1;
constexpr std::size_t kPeriodSamples = 6000;  // the cost has a wide minimum over periods
constexpr int kFullMoves = 3, kMoreMoves = 4;
constexpr double kUnsettled = 0.8;  // sigmas
/// Chance lets the cost fall by as much through seven joint zeros once in twenty times. Zeros of a robot that
/// has none would only carry noise into the pose.
constexpr double kSignificantFall = 14;
/// What the model leaves out (shading, mesh errors, the robust kernels' choice of pixels) made errors on
/// simulated captures this much larger, squared, than the scatter of residuals alone says. Part of it is
/// common to all pixels of a view and averages over views only.
constexpr double kModelAllowance = 1.25, kModelAllowanceOfOneView = 0.45;

class Refiner {
 public:
  Refiner(std::span<RegistrationView> views, const CameraModel& camera, const Pose& start,
          const RefineSettings& settings)
      : views_(views), camera_(camera), settings_(settings), predictions_(views.size()) {
    result_.T_base_sensor = start;
  }

  Refinement run() {
    const Stage stages[] = {{1, 3, 0.06, 0, false, false, false},
                            {1, 3, 0.03, 10, false, true, false},
                            {1, 2, 0, 5, false, true, false}};
    const bool zeros = settings_.joint_zero_prior > 0;
    Stage closing{settings_.final_renderings, 2, 0, 3, true, true, zeros};
    Stage last{2, 1, 0, 3, true, true, zeros};
    const Stage judged = last;  // what is known is known with the zeros free, whether they are used or not
    double progress = 0;
    for (const Stage& stage : stages) {
      run_stage(stage);
      progress += 0.25;
      if (settings_.keep_going && !settings_.keep_going(progress)) return result_;
    }
    move(closing, 0);
    choose_period(closing);
    run_stage(closing);
    if (zeros && fall_by_joint_zeros(last_information_, result_.joint_zeros) < kSignificantFall) {
      closing.free_zeros = last.free_zeros = false;
      set_zeros(JointZeros::Zero());
    }
    run_stage(last);
    for (int i = 0; i < kMoreMoves && result_.last_step_sigmas > kUnsettled; ++i) move(last, kFullMoves);
    finish(judged);
    return result_;
  }

 private:
  void run_stage(const Stage& stage) {
    moves_.clear();
    for (int i = 0; i < stage.renderings && (i == 0 || last_move_ > settings_.convergence_sigmas); ++i)
      move(stage, i);
  }

  void linearize(const Stage& stage) {
    LinearizationSettings settings;
    settings.range = range_settings(stage);
    for (std::size_t k = 0; k < kEdgeSources.size(); ++k)
      settings.contour[k] = contour_settings(stage, kEdgeSources[k]);
    settings.stride = stage.stride;
    settings.contour_stride =
        stage.contour_search_px > 0 ? (stage.stride == 1 ? kFineContourStride : kContourStride) : 0;
    latest_.observe(views_, predictions_, camera_, result_.T_base_sensor, result_.correction, settings);
  }

  ContourSettings contour_settings(const Stage& stage, EdgeSource source) const {
    ContourSettings contour;
    contour.source = source;
    const bool used = source == EdgeSource::image || settings_.use_depth_outline;
    contour.search_px = contour.kernel_px = used ? stage.contour_search_px : 0;
    // Once profiles are fitted, what lies several sigmas away is another edge.
    const double sigma_px = noise_.edges[static_cast<std::size_t>(source)].sigma_px;
    if (stage.fit_profile)
      contour.kernel_px = std::clamp(kKernelSigmas * sigma_px, 0.7, stage.contour_search_px);
    contour.fit_profile = stage.fit_profile;
    contour.shift_px = source == EdgeSource::image ? result_.image_shift_px : result_.depth_shift_px;
    return contour;
  }

  RangeSettings range_settings(const Stage& stage) const {
    RangeSettings range;
    range.kept_kernels = 1.5;
    range.sigma_factor = noise_.sigma_factor;
    range.lateral_px = noise_.lateral_px;
    const double noise_m = noise_.sigma_factor * 1.6e-3;
    range.kernel_m = stage.range_kernel_m > 0 ? stage.range_kernel_m
                                              : std::clamp(kKernelSigmas * noise_m, kMinKernel_m, 0.04);
    return range;
  }

  /// How far from the rendering range alone would have the parameters.
  ParameterVector range_alone(const Stage& stage, const ViewSums& sums) {
    const double scale = robust_sigma(sums.range_tally.whitened);
    ParameterVector gradient;
    const ParameterMatrix information =
        with_priors(sums.range.scaled(1 / (scale * scale)), stage, ParameterVector::Zero(), gradient);
    return information.ldlt().solve(gradient);
  }

  /// `delta`: how far the parameters have moved from result_.
  void add_priors(const Stage& stage, const ParameterVector& delta, ParameterMatrix& information,
                  ParameterVector& gradient) {
    freedom_.bias = stage.free_bias;
    freedom_.zeros = stage.free_zeros;
    add_prior(from_expected(result_, freedom_) + delta, prior_sigmas(settings_, freedom_), information,
              gradient);
  }

  ParameterMatrix with_priors(const NormalEquations& all, const Stage& stage, const ParameterVector& delta,
                              ParameterVector& gradient) {
    ParameterMatrix information = all.information().selfadjointView<Eigen::Lower>();
    gradient = all.gradient();
    add_priors(stage, delta, information, gradient);
    return information;
  }

  /// From what the last rendering showed, before its move.
  void choose_period(const Stage& stage) {
    const ViewSums sums = latest_.sums(ParameterVector::Zero());
    const NormalEquations edges = noise_.weighed_edges(sums);
    ParameterMatrix information = edges.information();
    ParameterVector gradient = edges.gradient();
    add_priors(stage, -latest_delta_, information, gradient);
    const std::vector<Sample> samples = latest_.range_samples(kPeriodSamples);
    const double each_for = static_cast<double>(latest_.range_count()) /
                            static_cast<double>(std::max<std::size_t>(1, samples.size()));
    if (const auto term = find_period(samples, each_for * noise_.range_weight(sums), information, gradient)) {
      result_.correction.periodic_period_m = freedom_.period_m = term->period_m;
      result_.correction.periodic_sin_m = term->sin_m;
      result_.correction.periodic_cos_m = term->cos_m;
      freedom_.periodic_m = std::min(term->prior_m, settings_.periodic_prior_m);
    }
  }

  /// Renders once and moves to where the steps lead.
  void move(const Stage& stage, int rendering) {
    linearize(stage);
    ParameterVector delta = ParameterVector::Zero(), full_step = delta;
    SensorNoise found = noise_;  // with which the next rendering is looked at
    for (int step = 0; step < kStepsPerRendering; ++step) {
      const ViewSums sums = latest_.sums(delta);
      if (step == 0 && stage.range_kernel_m == 0)
        found = noise_.found_in(latest_, sums, range_alone(stage, sums));
      if (step == 0) found.note_edges(sums);
      const NormalEquations all = found.weighed(sums);
      if (all.count() < 50) return lose_hold();
      ParameterVector gradient;
      last_information_ = with_priors(all, stage, delta, gradient);
      full_step = last_information_.ldlt().solve(gradient);
      delta += full_step;
      if (full_step.dot(gradient) < kSettled * kSettled) break;
    }
    noise_ = found;
    note_move(delta.head<6>(), full_step.head<6>());
    // Image edges and pixels change sides between renderings; halved moves settle that jitter.
    latest_delta_ = (rendering < kFullMoves ? 1.0 : 0.5) * delta;
    apply(latest_delta_, stage.free_zeros);
  }

  /// Too little is seen to say anything.
  void lose_hold() {
    latest_delta_.setZero();
    result_.last_step_sigmas = last_move_ = std::numeric_limits<double>::infinity();
  }

  void apply(const ParameterVector& delta, bool zeros_too) {
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
    if (zeros_too) set_zeros(result_.joint_zeros + delta.tail<kMaxJointZeros>());
  }

  void set_zeros(const JointZeros& zeros) {
    result_.joint_zeros = zeros;
    for (RegistrationView& view : views_) view.apply_zeros(zeros);
  }

  /// How far the pose still drifts: the mean of the stage's last moves, whole ones, in its own standard
  /// deviations. Pixels that change sides make single moves jitter; what has not settled keeps its direction
  /// and its size. A move that shifts no pixel's ray off its place on the surface needs no other rendering:
  /// the steps on this one have settled what there was to settle.
  void note_move(const Vector6d& pose_move, const Vector6d& last_step) {
    constexpr std::size_t kRemembered = 2;
    moves_.push_back(pose_move);
    if (moves_.size() > kRemembered) moves_.erase(moves_.begin());
    Vector6d mean = Vector6d::Zero();
    for (const Vector6d& move : moves_) mean += move / static_cast<double>(moves_.size());
    const ParameterMatrix covariance = last_information_.ldlt().solve(ParameterMatrix::Identity());
    const Eigen::LDLT<Matrix6d> of_pose(covariance.topLeftCorner<6, 6>());
    const auto sigmas = [&](const Vector6d& move) { return std::sqrt(move.dot(of_pose.solve(move)) / 6); };
    last_move_ = sigmas(pose_move);
    if (last_move_ < 1 && shift_px(pose_move) < kSamePlace_px) last_move_ = sigmas(last_step);
    result_.last_step_sigmas = std::min(last_move_, sigmas(mean));
  }

  /// About so far (px) a move shifts what the sensor sees of the robot.
  double shift_px(const Vector6d& pose_move) const {
    return camera_.fx * (pose_move.head<3>().norm() + pose_move.tail<3>().norm() / latest_.nearest_m());
  }

  void finish(const Stage& stage) {
    ViewSums sums = latest_.sums(latest_delta_);
    const NormalEquations all = noise_.weighed(sums);
    result_.sigma_factor = noise_.sigma_factor;
    result_.lateral_px = noise_.lateral_px;
    result_.range_correlation = noise_.range_correlation;
    ParameterVector gradient;
    const ParameterMatrix information = with_priors(all, stage, ParameterVector::Zero(), gradient);
    publish_for_reported_joints(parameter_covariance(information, all));
    result_.residual_rms_m = sums.range.rms_residual();
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
    const double allowance = kModelAllowance + kModelAllowanceOfOneView / static_cast<double>(views_.size());
    result_.covariance =
        allowance * views_per_posture(views_) * published * covariance * published.transpose();
    result_.joint_zero_sigmas = covariance.diagonal().tail<kMaxJointZeros>().cwiseSqrt();
    result_.T_base_sensor =
        perturbed(result_.T_base_sensor, published.rightCols<kMaxJointZeros>() * result_.joint_zeros);
  }

  std::span<RegistrationView> views_;
  const CameraModel& camera_;
  const RefineSettings& settings_;
  std::vector<VirtualMeasurement> predictions_;
  Refinement result_;
  Linearization latest_;
  ParameterVector latest_delta_ = ParameterVector::Zero();  // moved since
  std::vector<Vector6d> moves_;                             // of the stage
  ParameterMatrix last_information_ = ParameterMatrix::Zero();
  Freedom freedom_;
  SensorNoise noise_;
  double last_move_ = 0;  // of the pose, in its own standard deviations
};

}  // namespace

Refinement refine(std::span<RegistrationView> views, const CameraModel& camera, const Pose& start,
                  const RefineSettings& settings) {
  return Refiner(views, camera, start, settings).run();
}

}  // namespace calibrd
