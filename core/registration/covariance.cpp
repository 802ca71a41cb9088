// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/covariance.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace calibrd {

Matrix6d pose_covariance(const ParameterMatrix& information, const NormalEquations& equations) {
  const ParameterMatrix model = information.ldlt().solve(ParameterMatrix::Identity());
  const ParameterMatrix sandwich = model * equations.cluster_scatter() * model;
  const Matrix6d pose_model = model.topLeftCorner<6, 6>(), pose_sandwich = sandwich.topLeftCorner<6, 6>();
  // In the frame that whitens the model's covariance the sandwich's eigenvalues say how much larger it is.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> ratio(pose_sandwich, pose_model);
  if (ratio.info() != Eigen::Success) return pose_model;
  const Matrix6d axes = pose_model * ratio.eigenvectors();  // eigenvectors V: Vᵀ model V = 1
  const Vector6d growth = ratio.eigenvalues().cwiseMax(1.0);
  return axes * growth.asDiagonal() * axes.transpose();
}

}  // namespace calibrd
