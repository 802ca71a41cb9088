// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/calibration/calibrate.hpp"

namespace calibrd {

/// Why nothing can be made of the views; nothing when something can.
std::optional<Reason> unusable(const RobotModel& robot, const CameraModel& camera,
                               std::span<const View> views);

/// The views without those in which something covered the sensor, where four others are left; else none.
std::vector<View> without_empty(std::span<const View> views);

}  // namespace calibrd
