// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/planning/planning_settings.hpp"
#include "core/registration/normal_equations.hpp"
#include "core/registration/registration_view.hpp"

namespace calibrd {

/// What postures would say about a sensor's pose, before they are seen: the virtual measurement, on a grid
/// made coarser, stands in for the real one, and the same residuals as the refinement's give the information.
/// One thread at a time.
class ExpectedViews {
 public:
  /// `covariance`: of the pose as known now, after perturbed().
  ExpectedViews(const VirtualCell& cell, const CameraModel& camera, const Pose& T_base_sensor,
                const Matrix6d& covariance, std::span<const std::vector<double>> seen_postures,
                const PlanningSettings& settings);

  /// The covariance expected once the posture is seen, too, and how much of the robot it shows.
  struct Expectation {
    Matrix6d covariance;
    std::size_t robot_pixels = 0;  ///< on the full grid, measurable ones
  };
  /// Nothing: too little of the robot is in view.
  std::optional<Expectation> after(const std::vector<double>& posture);

 private:
  struct Seen {
    ParameterMatrix information = ParameterMatrix::Zero();
    std::size_t robot_pixels = 0;
  };
  using PoseByZeros = Eigen::Matrix<double, 6, kMaxJointZeros>;
  Seen see(std::size_t slot, const std::vector<double>& posture);
  PoseByZeros by_zeros(std::size_t views) const;
  Matrix6d published(const ParameterMatrix& information, std::size_t views) const;
  Matrix6d after_one(const ParameterMatrix& seen) const;
  void compare_with_known(const Matrix6d& covariance);

  const PlanningSettings settings_;
  const int reduction_;
  const std::size_t least_pixels_;
  const CameraModel coarse_, noise_camera_;
  const Pose T_base_sensor_;
  std::vector<RegistrationView> views_;  // of the postures seen, and a last one for a candidate
  std::vector<VirtualMeasurement> predictions_;
  ParameterMatrix information_;  // of all that is known
  Matrix6d correction_;          // C: C · expected · Cᵀ is what was found
};

}  // namespace calibrd
