// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "core/base/result.hpp"
#include "core/robot/controller_frame.hpp"
#include "core/robot/joint_mapping.hpp"
#include "core/robot/robot_model.hpp"
#include "server/config/config.hpp"

namespace calibrd {

// What a configuration points to, read and checked. Errors name the file or key at fault.
Result<RobotModel> load_model(const RobotConfig& robot);
/// Warns of an order of joints that looks like the pendant's.
Result<JointMapping> make_mapping(const Config& config, const RobotModel& model);
/// Nothing where none is configured.
Result<std::optional<ControllerFrame>> controller_frame(const RobotModel& model, const RobotConfig& robot);
Status check_sensors(const Config& config);

/// All of it: robot model, joints, sensors' settings. Opens no port and no store.
Status check_config(const Config& config);

}  // namespace calibrd
