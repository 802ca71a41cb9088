// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "core/calibration/calibrate.hpp"

namespace calibrd {

/// One way in which the input may be wrong, undone.
struct Alternative {
  Reason reason;           ///< to give when it fits
  bool of_sensor = false;  ///< of the sensor; else of the joints
  std::function<CameraModel(const CameraModel&)> camera = [](const CameraModel& c) { return c; };
  /// The joints of view `view`, given those of all views; empty when there are none.
  std::function<std::vector<double>(const std::vector<std::vector<double>>&, std::size_t)> joints =
      [](const auto& all, std::size_t view) { return all[view]; };
  bool mirrored = false;  ///< the rows of the depth image, flipped
};

/// Everything that diagnose() tries, the likeliest first.
std::vector<Alternative> alternatives(const std::vector<std::string>& joint_names);

}  // namespace calibrd
