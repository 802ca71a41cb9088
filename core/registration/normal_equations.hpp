// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/registration/joint_axes.hpp"

namespace calibrd {

/// What is estimated: the pose's δ = (δω, δt) as in perturbed(); offset (m), scale - 1 and the periodic term
/// of the range (sine and cosine in m, period in m); how far (px) edges of the image and of the depth lie
/// outside the predicted contours; and the joint zeros (rad or m), true position minus reported one.
enum Parameter : int {
  kPose = 0,
  kOffset = 6,
  kScale,
  kSine,
  kCosine,
  kPeriod,
  kImageShift,
  kDepthShift,
  kJointZeros
};
constexpr int kParameters = kJointZeros + kMaxJointZeros;
using ParameterVector = Eigen::Matrix<double, kParameters, 1>;
using ParameterMatrix = Eigen::Matrix<double, kParameters, kParameters>;

/// One weighted observation: `jacobian` is the derivative of the *prediction* by the parameters, `residual`
/// is measured minus predicted, both in the same unit.
struct Observation {
  ParameterVector jacobian;
  double residual = 0;
  double sigma = 1;          ///< standard deviation of the residual, same unit
  double robust_weight = 1;  ///< 0..1
};

/// Tukey's biweight: weight of a residual under a kernel of that half width, 0..1.
inline double tukey_weight(double residual, double kernel) {
  const double x = residual / kernel;
  return x > -1 && x < 1 ? (1 - x * x) * (1 - x * x) : 0;
}

/// An observation that is kept: as the parameters move by a small δ its residual moves by -J δ.
struct Sample {
  Observation observation;
  std::size_t cluster = 0;
  /// Of a range: where it was measured, and how much farther the surface lies one pixel on (m per pixel).
  double depth_m = 0, depth_per_pixel_m = 0;
};

/// Images are worked on in bands of so many rows, which no cluster straddles.
constexpr int kBandRows = 72;

/// Rows of a prediction: [first, end).
struct RowBand {
  int first = 0;
  int end = std::numeric_limits<int>::max();
};

/// Gauss-Newton sums over observations. Observations are grouped into clusters whose errors may be correlated
/// (neighbouring pixels): their gradients are kept apart for the covariance.
class NormalEquations {
 public:
  void add(const Observation& observation, std::size_t cluster);
  /// Adds the sums of `other`; its clusters stay apart from ours.
  void merge(const NormalEquations& other);

  /// The same sums with every weight multiplied by `factor`.
  NormalEquations scaled(double factor) const;

  ParameterMatrix information() const;  ///< symmetric
  const ParameterVector& gradient() const { return gradient_; }
  std::size_t count() const { return count_; }
  double rms_residual() const;  ///< of inliers, in the unit of the residuals

  /// How many times the scatter of the cluster sums exceeds that of independent observations (1 =
  /// independent): the factor by which a covariance that assumes independence is too small, at least 1.
  double correlation_factor() const;
  /// The same where the parameters have moved by `delta`.
  double correlation_factor(const ParameterVector& delta) const;

  /// Σ over clusters of g gᵀ: the middle of the sandwich covariance.
  ParameterMatrix cluster_scatter() const;

 private:
  struct Cluster {
    ParameterVector gradient = ParameterVector::Zero();
    ParameterVector whitened_jacobian = ParameterVector::Zero();  // Σ w J/σ
    double whitened_sum = 0;                                      // Σ w r/σ
    double whitened_squares = 0;                                  // Σ (w r/σ)²
  };
  // Columns are padded to whole vector registers; only what lies on and below the diagonal is kept up.
  static constexpr int kPadded = (kParameters + 3) / 4 * 4;
  Eigen::Matrix<double, kPadded, kParameters> information_ =
      Eigen::Matrix<double, kPadded, kParameters>::Zero();
  ParameterVector gradient_ = ParameterVector::Zero();
  double weight_sum_ = 0, residual_squares_ = 0;
  std::size_t count_ = 0;
  std::vector<Cluster> clusters_;
};

}  // namespace calibrd
