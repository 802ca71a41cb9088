// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "core/geometry/pose.hpp"

namespace calibrd {

/// Where a sensor that has moved has come to rest, as its background tells frame by frame. Views of before
/// and after a move never come together, also while the sensor goes on moving. Without I/O; one thread.
class RestingPlace {
 public:
  /// Where one frame shows the sensor.
  struct Sight {
    Pose T_base_sensor;
    double shift_sigma_m, turn_sigma_rad;  ///< of what the sensor sees
  };

  void forget() { place_.reset(); }
  /// The next frame. True: what was seen before it was seen from elsewhere, or nobody knew yet that the
  /// sensor had moved. A frame that does not show where the sensor is says nothing: it may rest where it was.
  bool is_new(const std::optional<Sight>& sight);

 private:
  std::optional<Sight> place_;
};

}  // namespace calibrd
