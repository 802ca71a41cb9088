// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/geometry/pose.hpp"
#include "core/registration/normal_equations.hpp"

namespace calibrd {

/// Covariance of the pose δ from the sums at the optimum, range offset and scale marginalised. `information`
/// holds the priors too; `equations` the observations, already weighted by their correlation. Taken is the
/// larger, per direction, of the model's covariance and the sandwich estimate from the scatter of clusters.
Matrix6d pose_covariance(const ParameterMatrix& information, const NormalEquations& equations);

}  // namespace calibrd
