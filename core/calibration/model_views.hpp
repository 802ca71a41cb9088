// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "core/capture/capture.hpp"
#include "core/robot/robot_model.hpp"

namespace calibrd {

/// The views of a recording with their joints in the order of the robot model.
/// Errors: CaptureError::unknown_joint (the recording names a joint the model has not), missing_joint (the
/// model needs a joint the recording has not), duplicate_joint.
Result<std::vector<View>> views_in_model_order(const RobotModel& robot, Capture capture);

}  // namespace calibrd
