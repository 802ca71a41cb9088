// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/resting_place.hpp"

#include <cmath>

namespace calibrd {
namespace {

/// A sensor that rests is seen from frame to frame within this, and within what the frames leave open: along
/// a wall one frame may tell a centimetre less than the next.
constexpr double kRest_m = 0.005, kRest_rad = 0.004, kSigmas = 4;
/// From the sensor to the middle of what it sees, about: what a turn about that makes of the sensor's place.
constexpr double kLever_m = 2;

bool is_at(const RestingPlace::Sight& place, const RestingPlace::Sight& sight) {
  const Vector6d since = difference(place.T_base_sensor, sight.T_base_sensor);
  const double turn_sigma = std::hypot(place.turn_sigma_rad, sight.turn_sigma_rad);
  const double shift_sigma = std::hypot(place.shift_sigma_m, sight.shift_sigma_m, kLever_m * turn_sigma);
  return since.head<3>().norm() < kRest_rad + kSigmas * turn_sigma &&
         since.tail<3>().norm() < kRest_m + kSigmas * shift_sigma;
}

}  // namespace

bool RestingPlace::is_new(const std::optional<Sight>& sight) {
  if (!sight) return false;
  const bool is_elsewhere = !place_ || !is_at(*place_, *sight);
  // A better look is the better measure of the next.
  if (is_elsewhere || sight->shift_sigma_m < place_->shift_sigma_m) place_ = sight;
  return is_elsewhere;
}

}  // namespace calibrd
