// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/base/result.hpp"

namespace calibrd::sim {

struct RunOptions {
  std::filesystem::path description;          ///< world.json
  std::filesystem::path urdf;                 ///< empty: the description's
  std::vector<std::filesystem::path> models;  ///< folders with packages
  std::filesystem::path world_file;           ///< the shared world; CALIBRD_SIM_WORLD of drivers names it
  std::filesystem::path ready_file;           ///< empty: none. Holds the ready line once all ports are open
  std::uint16_t controller_port = 50241;      ///< 0: any free one
  std::uint16_t motion_port = 0;              ///< 0: any free one
  std::uint16_t control_port = 8078;          ///< 0: any free one
};

/// Runs the simulated cell until SIGTERM or SIGINT. Prints one line when all is up:
/// ready controller=127.0.0.1:PORT motion=127.0.0.1:PORT control=127.0.0.1:PORT world=PATH
Status run_cell(const RunOptions& options);

}  // namespace calibrd::sim
