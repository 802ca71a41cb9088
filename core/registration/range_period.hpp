// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "core/registration/range_residuals.hpp"

namespace calibrd {

/// The period (m) of the range's periodic term that explains the samples best, everything else solved for
/// beside it. `rest` holds what else is known (contours, priors): information and gradient. The solution is
/// linear in sine and cosine for each candidate, so no rendering is needed. `sample_weight`:
/// correlation-aware weight of the samples, whose Jacobians hold nothing of a periodic term. Returns nothing
/// when no candidate explains more than no periodic term at all.
struct PeriodicTerm {
  double period_m, sin_m, cos_m;
  double prior_m;  ///< standard deviation of either amplitude before they were seen, as the samples have it
};
std::optional<PeriodicTerm> find_period(std::span<const Sample> samples, double sample_weight,
                                        const ParameterMatrix& rest_information,
                                        const ParameterVector& rest_gradient);

}  // namespace calibrd
