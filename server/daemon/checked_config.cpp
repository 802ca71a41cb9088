// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/checked_config.hpp"

#include <spdlog/spdlog.h>

#include "drivers/sensor/sensor_process.hpp"
#include "server/daemon/conversions.hpp"
#include "server/daemon/fleet_link.hpp"
#include "server/daemon/motion_link.hpp"
#include "server/daemon/robot_link.hpp"
#include "server/security/exposure.hpp"
#include "server/security/token_file.hpp"

namespace calibrd {
namespace {

Status check_tokens(const ServerConfig& server) {
  if (server.tokens_file.empty()) return Done{};
  if (const auto tokens = read_tokens(server.tokens_file); !tokens) return tokens.error();
  return Done{};
}

}  // namespace

Result<std::optional<ControllerFrame>> controller_frame(const RobotModel& model, const RobotConfig& robot) {
  if (robot.controller_frame.empty()) return std::optional<ControllerFrame>();
  auto frame = find_controller_frame(model, robot.controller_frame);
  if (!frame) return Error{frame.error().code, "robot.controller_frame " + frame.error().detail};
  return std::optional(*std::move(frame));
}

Result<RobotModel> load_model(const RobotConfig& robot) {
  auto model = RobotModel::load(robot.urdf, {robot.search_paths, robot.base_link});
  if (!model) return model;
  if (const auto frame = controller_frame(*model, robot); !frame) return frame.error();
  return model;
}

Result<JointMapping> make_mapping(const Config& config, const RobotModel& model) {
  const auto wanted = mapping_config(config.robot, model.position_names());
  auto mapping = JointMapping::make(wanted, model.position_names());
  if (mapping)
    if (const auto doubt = find_pendant_order(*mapping)) spdlog::warn("robot.joints: {}", doubt->message());
  return mapping;
}

Status check_sensors(const Config& config) {
  for (const auto& [id, sensor] : config.sensors)
    if (auto status = check(sensor_settings(id, sensor)); !status)
      return Error{status.error().code, "sensors." + id + ": " + status.error().detail};
  return Done{};
}

Status check_config(const Config& config) {
  if (auto status = check_exposure(config.server); !status) return status;
  if (auto status = check_tokens(config.server); !status) return status;
  const auto model = load_model(config.robot);
  if (!model) return model.error();
  const auto mapping = make_mapping(config, *model);
  if (!mapping) return mapping.error();
  if (auto status = check_motion(config, *model, *mapping); !status) return status;
  if (auto status = check(link_settings(config.robot)); !status) return status;
  if (auto status = check_mqtt(config); !status) return status;
  if (auto status = check_mqtt_files(config); !status) return status;
  return check_sensors(config);
}

}  // namespace calibrd
