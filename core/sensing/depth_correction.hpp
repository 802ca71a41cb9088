// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <numbers>

namespace calibrd {

/// What a depth sensor does to the true depth z (along the optical axis, m):
/// z_measured = scale * z + offset_m + sin_m * sin(2πz/period_m) + cos_m * cos(2πz/period_m).
/// The periodic term is the "wiggling" of time-of-flight sensors.
struct DepthCorrection {
  double scale = 1;
  double offset_m = 0;
  double periodic_sin_m = 0;
  double periodic_cos_m = 0;
  double periodic_period_m = 0;  ///< 0: no periodic term was estimated

  double measured(double z) const {
    if (periodic_period_m <= 0) return scale * z + offset_m;
    const double phase = 2 * std::numbers::pi * z / periodic_period_m;
    return scale * z + offset_m + periodic_sin_m * std::sin(phase) + periodic_cos_m * std::cos(phase);
  }
  /// d measured / d z.
  double slope(double z) const {
    if (periodic_period_m <= 0) return scale;
    const double rate = 2 * std::numbers::pi / periodic_period_m;
    return scale + rate * (periodic_sin_m * std::cos(rate * z) - periodic_cos_m * std::sin(rate * z));
  }
  /// The true depth of a measured one (Newton's steps; the errors are millimetres).
  double truth(double z_measured) const {
    double z = z_measured;
    for (int step = 0; step < 3; ++step) z -= (measured(z) - z_measured) / slope(z);
    return z;
  }
  double periodic_amplitude_m() const { return std::hypot(periodic_sin_m, periodic_cos_m); }
};

}  // namespace calibrd
