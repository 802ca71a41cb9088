// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/covariance.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace calibrd {

ParameterMatrix parameter_covariance(const ParameterMatrix& information, const NormalEquations& equations) {
  const ParameterMatrix model = information.ldlt().solve(ParameterMatrix::Identity());
  const ParameterMatrix sandwich = model * equations.cluster_scatter() * model;
  // In the frame that whitens the model's covariance the sandwich's eigenvalues say how much larger it is.
  const Eigen::GeneralizedSelfAdjointEigenSolver<ParameterMatrix> ratio(sandwich, model);
  if (ratio.info() != Eigen::Success) return model;
  const ParameterMatrix axes = model * ratio.eigenvectors();  // eigenvectors V: Vᵀ model V = 1
  const ParameterVector growth = ratio.eigenvalues().cwiseMax(1.0);
  return axes * growth.asDiagonal() * axes.transpose();
}

double fall_by_joint_zeros(const ParameterMatrix& information, const JointZeros& zeros) {
  const Eigen::MatrixXd coupling = information.bottomLeftCorner(kMaxJointZeros, kJointZeros);
  const Eigen::MatrixXd others = information.topLeftCorner(kJointZeros, kJointZeros);
  const Eigen::MatrixXd alone = information.bottomRightCorner(kMaxJointZeros, kMaxJointZeros) -
                                coupling * others.ldlt().solve(coupling.transpose());
  return zeros.dot(alone * zeros);
}

}  // namespace calibrd
