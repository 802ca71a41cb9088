// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "core/calibration/calibrate.hpp"

namespace calibrd {

/// The paper's method as a calibration: from the first view, `settings.paper` and the guess, which it cannot
/// do without. It knows no uncertainty and no verdict of its own: its pose is never more than uncertain.
CalibrationResult calibrate_by_paper(const RobotModel& robot, const CameraModel& camera,
                                     std::span<const View> views, const CalibrationSettings& settings);

}  // namespace calibrd
