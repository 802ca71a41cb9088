// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "api/http/http_server.hpp"
#include "core/robot/joint_mapping.hpp"
#include "core/robot/robot_model.hpp"
#include "drivers/robot/motion/motion_client.hpp"
#include "drivers/robot/state_client.hpp"
#include "drivers/sensor/sensor_settings.hpp"
#include "server/config/config.hpp"
#include "server/live_cell/live_cell.hpp"

namespace calibrd {

// From the configuration to what each part takes.
api::HttpServerSettings http_settings(const Config& config);
StateClientSettings link_settings(const RobotConfig& robot);
MotionClientSettings motion_client_settings(const Config& config);
SensorProcessSettings sensor_settings(const std::string& id, const SensorConfig& sensor);
RobotMotionSettings motion_settings(const MotionConfig& motion);
SensorSetup sensor_setup(const std::string& id, const SensorConfig& sensor);
DriftSettings drift_settings(const DriftConfig& drift);
LiveCellSettings cell_settings(const Config& config, const std::string& version);

/// Joints that the configuration does not name follow the controller's value at their own place in the model.
JointMappingConfig mapping_config(const RobotConfig& robot, const std::vector<std::string>& model_joints);

}  // namespace calibrd
