// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>

#include "core/registration/refine.hpp"

namespace calibrd {

/// Which parameters may leave what is expected of them.
struct Freedom {
  bool bias = false;    ///< range offset and scale
  bool zeros = false;   ///< of the joints
  double period_m = 0;  ///< of the range's periodic term, once one was chosen
  double periodic_m =
      std::numeric_limits<double>::infinity();  ///< what its amplitudes may be; at most the prior
};

/// Standard deviations of the parameters before anything was seen; infinite for the pose.
ParameterVector prior_sigmas(const RefineSettings& settings, const Freedom& freedom);

/// How far the parameters lie from where they were expected before the views were seen.
ParameterVector from_expected(const Refinement& refinement, const Freedom& freedom);

/// Adds what was known before, as one observation per parameter. `away`: how far the parameters lie from
/// where they were expected.
void add_prior(const ParameterVector& away, const ParameterVector& sigmas, ParameterMatrix& information,
               ParameterVector& gradient);

}  // namespace calibrd
