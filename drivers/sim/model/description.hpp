// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/sim/world/cell.hpp"
#include "drivers/sim/world/controller_settings.hpp"
#include "drivers/sim/world/state.hpp"

namespace calibrd::sim {

/// A simulated cell at the moment it is switched on.
struct World {
  Cell cell;
  WorldState state;
  ControllerSettings controller;
};

struct DescriptionOptions {
  std::filesystem::path urdf;                 ///< overrides the description's robot.urdf
  std::vector<std::filesystem::path> models;  ///< folders to look meshes up in
};

/// Reads a world description (JSON; docs/simulator.md lists the keys) and the robot it names. A relative
/// robot.urdf is looked up beside the description. Errors: description_*, those of read_robot,
/// no_free_posture.
Result<World> read_description(const std::filesystem::path& path, const DescriptionOptions& options);

/// As read_description, from text; `folder` is where relative paths start.
Result<World> parse_description(const std::string& text, const std::filesystem::path& folder,
                                const DescriptionOptions& options);

/// Gives every link its own brightness and mottling, as painted castings have.
void paint(Robot& robot, double albedo, double texture);

}  // namespace calibrd::sim
