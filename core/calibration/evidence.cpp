// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/evidence.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/registration/priors.hpp"
#include "core/registration/reported_joints.hpp"

namespace calibrd {
namespace {

constexpr int kStride = 2;
constexpr double kReach_m = 0.05;       // residuals beyond it are of something else
constexpr double kTolerance_m = 0.015;  // below a link's thickness
constexpr double kToleranceRms = 2.5;   // ... but noisy sensors need more
constexpr float kMinCosine = 0.25F;
constexpr float kRimStep = 0.025F;
constexpr std::size_t kLeastViewsHeldOut = 4;

std::vector<VirtualMeasurement> predict(std::span<const RegistrationView> views, const CameraModel& camera,
                                        const Pose& T_base_sensor) {
  std::vector<VirtualMeasurement> predictions(views.size());
  tbb::parallel_for(std::size_t{0}, views.size(),
                    [&](std::size_t v) { views[v].cell.measure(camera, T_base_sensor, predictions[v]); });
  return predictions;
}

/// Two pixels from the robot's edge a fraction of a pixel decides what is measured.
bool is_near_rim(const VirtualMeasurement& m, int x, int y) {
  if (x < 2 || y < 2 || x + 2 >= m.width || y + 2 >= m.height) return true;
  const auto at = [&](int u, int v) {
    return m.depth_m[static_cast<std::size_t>(v) * static_cast<std::size_t>(m.width) +
                     static_cast<std::size_t>(u)];
  };
  const float z = at(x, y);
  return std::ranges::any_of(std::array{at(x - 2, y), at(x + 2, y), at(x, y - 2), at(x, y + 2)},
                             [z](float neighbour) { return std::abs(neighbour - z) > 2 * kRimStep * z; });
}

void count(double residual, double tolerance_m, SurfaceTally& tally) {
  ++tally.measured;
  tally.agreeing += std::abs(residual) <= tolerance_m ? 1 : 0;
  tally.seen_through += residual > tolerance_m ? 1 : 0;
  tally.occluded += residual < -tolerance_m ? 1 : 0;
}

std::vector<SurfaceTally> tally_links(const RegistrationView& view, const VirtualMeasurement& prediction,
                                      const CameraModel& camera, const Refinement& refined) {
  const double tolerance_m = std::max(kTolerance_m, kToleranceRms * refined.residual_rms_m);
  std::vector<SurfaceTally> tallies(view.cell.robot().links().size());
  for (int y = 0; y < camera.height; y += kStride) {
    for (int x = 0; x < camera.width; x += kStride) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
      if (prediction.link[i] < 0 || is_near_rim(prediction, x, y)) continue;
      const Eigen::Vector3f d = view.rays->at(x, y).cast<float>();
      if (-prediction.normal[i].dot(d) < kMinCosine * d.norm()) continue;
      SurfaceTally& tally = tallies[static_cast<std::size_t>(prediction.link[i])];
      ++tally.predicted;
      if (view.depth_m[i] > 0)
        count(view.depth_m[i] - refined.correction.measured(prediction.depth_m[i]), tolerance_m, tally);
    }
  }
  return tallies;
}

/// What one view alone says of the parameters, sums and samples.
struct OneViewSums {
  NormalEquations equations;
  std::vector<Sample> samples;
};

OneViewSums sums_of(const RegistrationView& view, const VirtualMeasurement& prediction,
                    const CameraModel& camera, const Pose& T_base_sensor, const Refinement& refined) {
  RangeSettings settings;
  settings.kernel_m = kReach_m;
  settings.sigma_factor = refined.sigma_factor;
  settings.lateral_px = refined.lateral_px;
  settings.stride = 3;
  OneViewSums sums;
  RangeTally tally;
  observe_range(view, prediction, camera, T_base_sensor, refined.correction, settings, {}, sums.samples,
                tally);
  for (const Sample& sample : sums.samples) sums.equations.add(sample.observation, sample.cluster);
  return sums;
}

double median(std::vector<float> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double joint_pull_m(const OneViewSums& sums) {
  constexpr double kPrior_rad = 0.05;
  using Joints = Eigen::Matrix<double, kMaxJointZeros, 1>;
  using JointMatrix = Eigen::Matrix<double, kMaxJointZeros, kMaxJointZeros>;
  const ParameterMatrix all = sums.equations.information().selfadjointView<Eigen::Lower>();
  JointMatrix information = all.bottomRightCorner<kMaxJointZeros, kMaxJointZeros>();
  information.diagonal().array() += 1 / (kPrior_rad * kPrior_rad);
  const Joints zeros = information.ldlt().solve(sums.equations.gradient().tail<kMaxJointZeros>());
  double squares = 0;
  for (const Sample& sample : sums.samples) {
    const double moved = sample.observation.jacobian.tail<kMaxJointZeros>().dot(zeros);
    squares += moved * moved;
  }
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, sums.samples.size())));
}

/// What was known before, about where the solution is.
ParameterMatrix prior_information(const DepthCorrection& correction) {
  ParameterVector sigmas =
      prior_sigmas({}, {.bias = true, .zeros = true, .period_m = correction.periodic_period_m});
  sigmas.head<6>().setConstant(0.05);
  return sigmas.cwiseAbs2().cwiseInverse().asDiagonal();
}

/// One Gauss-Newton step on all views but one, from the common solution, and the residuals it leaves in the
/// one left out.
double held_out_residual_m(const std::vector<OneViewSums>& views, const Refinement& refined) {
  const double correlation = refined.range_correlation;
  ParameterMatrix information = prior_information(refined.correction);
  ParameterVector gradient = ParameterVector::Zero();
  for (const OneViewSums& view : views) {
    information +=
        ParameterMatrix(view.equations.information().selfadjointView<Eigen::Lower>()) / correlation;
    gradient += view.equations.gradient() / correlation;
  }
  std::vector<float> residuals;
  for (const OneViewSums& view : views) {
    const ParameterMatrix own = view.equations.information().selfadjointView<Eigen::Lower>();
    const ParameterVector step = ParameterMatrix(information - own / correlation)
                                     .ldlt()
                                     .solve(gradient - view.equations.gradient() / correlation);
    for (const Sample& sample : view.samples)
      residuals.push_back(
          static_cast<float>(std::abs(sample.observation.residual - sample.observation.jacobian.dot(step))));
  }
  return median(std::move(residuals));
}

/// Mean of what the views show of the robot.
Eigen::Vector3d middle_of(const std::vector<VirtualMeasurement>& predictions, const CameraModel& camera,
                          const Pose& T_base_sensor) {
  constexpr int kSparse = 8;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0;
  for (const VirtualMeasurement& m : predictions) {
    for (int y = 0; y < m.height; y += kSparse) {
      for (int x = 0; x < m.width; x += kSparse) {
        const float z = m.depth_m[static_cast<std::size_t>(y * m.width + x)];
        if (z <= 0) continue;
        sum += z * camera.ray(x, y);
        ++count;
      }
    }
  }
  return T_base_sensor * (count > 0 ? Eigen::Vector3d(sum / count) : Eigen::Vector3d::UnitZ());
}

}  // namespace

void SurfaceTally::merge(const SurfaceTally& other) {
  predicted += other.predicted;
  measured += other.measured;
  agreeing += other.agreeing;
  seen_through += other.seen_through;
  occluded += other.occluded;
}

Pose pose_of_true_base(std::span<const RegistrationView> views, const CameraModel& camera,
                       const Refinement& refined) {
  const auto predictions = predict(views, camera, refined.T_base_sensor);
  const auto map = reported_joints_map(views, predictions, camera, refined.T_base_sensor);
  return perturbed(refined.T_base_sensor, -map * refined.joint_zeros);
}

Evidence gather_evidence(std::span<const RegistrationView> views, const CameraModel& camera,
                         const Refinement& refined) {
  const Pose T_base_sensor = pose_of_true_base(views, camera, refined);
  const auto predictions = predict(views, camera, T_base_sensor);
  std::vector<std::vector<SurfaceTally>> tallies(views.size());
  std::vector<OneViewSums> sums(views.size());
  tbb::parallel_for(std::size_t{0}, views.size(), [&](std::size_t v) {
    tallies[v] = tally_links(views[v], predictions[v], camera, refined);
    sums[v] = sums_of(views[v], predictions[v], camera, T_base_sensor, refined);
  });
  Evidence evidence;
  evidence.robot_middle_base = middle_of(predictions, camera, T_base_sensor);
  evidence.images = look_at_images(views, predictions, camera);
  evidence.links.resize(views.front().cell.robot().links().size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    SurfaceTally& of_view = evidence.views.emplace_back();
    for (std::size_t link = 0; link < tallies[v].size(); ++link) {
      evidence.links[link].merge(tallies[v][link]);
      of_view.merge(tallies[v][link]);
    }
    evidence.joint_pull_m.push_back(joint_pull_m(sums[v]));
  }
  if (views.size() >= kLeastViewsHeldOut) evidence.held_out_residual_m = held_out_residual_m(sums, refined);
  return evidence;
}

}  // namespace calibrd
