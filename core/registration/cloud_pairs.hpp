// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/registration/surface_cloud.hpp"

namespace calibrd {

/// Gauss-Newton sums over pairs, for δ = (rotation about the origin, translation) applied after the pose.
/// The residuals' variance is left out: information / sigma² is the inverse of δ's covariance.
struct PairSums {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double weight = 0;
  double false_information = 0;  ///< per translation axis, what the normals' noise alone would give
};

/// Pairs of nearest neighbours between a source, moved, and a target; both must outlive it. Keeps its buffers
/// from step to step. One thread at a time.
class CloudPairs {
 public:
  CloudPairs(const SurfaceCloud& source, const SurfaceCloud& target);

  /// Pairs every source point, moved by the pose, with its nearest target point within `reach_m`. A partner
  /// further away than `lateral_m` along the surface is none: there the target has its border.
  void match(const Pose& T_target_source, float reach_m, float lateral_m);

  /// Robust standard deviation (m) of the pairs' distances along their normals; 0 when there is none.
  float sigma_m();

  /// Share of the source points with a partner within the kernel.
  double overlap(float kernel_m) const;

  /// Sums with the weights of Tukey's biweight of this width.
  PairSums sums(float kernel_m) const;

 private:
  /// What one source point finds; a zero normal when it finds nothing.
  struct Pair {
    Eigen::Vector3f point = Eigen::Vector3f::Zero();  // of the source, moved
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    float distance = 0;  // along the normal, to the target's point
    float normal_variance = 0;
    bool exists() const { return !normal.isZero(0); }
  };
  Pair join(std::size_t i, std::size_t partner, const Eigen::Vector3f& point, const Eigen::Matrix3f& R,
            float lateral_m) const;

  const SurfaceCloud& source_;
  const SurfaceCloud& target_;
  std::vector<Pair> pairs_;         // one per source point
  std::vector<int> partners_;       // of the last match
  std::vector<float> distances_m_;  // scratch of sigma_m()
};

}  // namespace calibrd
