// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/priors.hpp"

#include <algorithm>

namespace calibrd {

ParameterVector prior_sigmas(const RefineSettings& settings, const Freedom& freedom) {
  constexpr double kHeld = 1e-7;
  ParameterVector sigmas = ParameterVector::Constant(std::numeric_limits<double>::infinity());
  sigmas[kOffset] = freedom.bias ? settings.offset_prior_m : kHeld;
  sigmas[kScale] = freedom.bias ? settings.scale_prior : kHeld;
  sigmas[kSine] = sigmas[kCosine] = std::min(freedom.periodic_m, settings.periodic_prior_m);
  sigmas[kPeriod] = freedom.period_m > 0 ? settings.period_prior * freedom.period_m : 1;
  sigmas[kImageShift] = settings.image_shift_prior_px;
  sigmas[kDepthShift] = settings.depth_shift_prior_px;
  sigmas.tail<kMaxJointZeros>().setConstant(freedom.zeros ? settings.joint_zero_prior : kHeld);
  return sigmas;
}

ParameterVector from_expected(const Refinement& refinement, const Freedom& freedom) {
  const DepthCorrection& c = refinement.correction;
  ParameterVector away = ParameterVector::Zero();
  away[kOffset] = c.offset_m;
  away[kScale] = c.scale - 1;
  away[kSine] = c.periodic_sin_m;
  away[kCosine] = c.periodic_cos_m;
  away[kPeriod] = c.periodic_period_m > 0 ? c.periodic_period_m - freedom.period_m : 0;
  away[kImageShift] = refinement.image_shift_px;
  away[kDepthShift] = refinement.depth_shift_px;
  away.tail<kMaxJointZeros>() = refinement.joint_zeros;
  return away;
}

void add_prior(const ParameterVector& away, const ParameterVector& sigmas, ParameterMatrix& information,
               ParameterVector& gradient) {
  const ParameterVector weights = sigmas.cwiseAbs2().cwiseInverse();
  information.diagonal() += weights;
  gradient -= weights.cwiseProduct(away);
  // A faint hold keeps the solution finite in directions that nothing pins.
  information.diagonal().head<6>().array() += 1e-9 * information.diagonal().head<6>().maxCoeff();
}

}  // namespace calibrd
