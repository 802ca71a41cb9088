// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/depth_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace calibrd {

double depth_per_pixel_m(double z, double cos_incidence, double pixel_m) {
  const double cosine = std::clamp(cos_incidence, 0.05, 1.0);
  return pixel_m * z * std::sqrt(1 - cosine * cosine) / cosine;
}

double depth_sigma_m(double z, double cos_incidence, double pixel_m, double lateral_px) {
  const double angle = std::acos(std::clamp(cos_incidence, 0.05, 1.0));
  const double rest = std::numbers::pi / 2 - angle;
  const double axial_mm =
      1.5 - 0.5 * z + 0.3 * z * z + 0.1 * z * std::sqrt(z) * angle * angle / (rest * rest);
  const double lateral_m = lateral_px * depth_per_pixel_m(z, cos_incidence, pixel_m);
  return std::sqrt(1e-6 * axial_mm * axial_mm + lateral_m * lateral_m);
}

}  // namespace calibrd
