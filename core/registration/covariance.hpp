// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/registration/normal_equations.hpp"

namespace calibrd {

/// Covariance of all parameters from the sums at the optimum. `information` holds the priors too; `equations`
/// the observations, already weighted by their correlation. Taken is the larger, per direction, of the
/// model's covariance and the sandwich estimate from the scatter of clusters.
ParameterMatrix parameter_covariance(const ParameterMatrix& information, const NormalEquations& equations);

/// How far the cost falls by the joint zeros found, everything else solved for beside them: of chance alone
/// about one per joint that the views show.
double fall_by_joint_zeros(const ParameterMatrix& information, const JointZeros& zeros);

}  // namespace calibrd
