// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/sim/world/robot.hpp"

namespace calibrd::sim {

/// A thing that stands in the cell: workbench, box, wall. Its place is in WorldState::objects at the same
/// index.
struct Object {
  std::string name;
  Mesh mesh;
  Surface surface;
};

/// All that does not change in the simulated cell.
struct Cell {
  Robot robot;
  std::vector<Object> objects;
};

/// The cell as bytes, for the shared world file. Fields in the machine's byte order: both ends are one build.
std::vector<std::byte> to_bytes(const Cell& cell);

/// Errors: SimError::world_mismatch when the bytes are not such a cell.
Result<Cell> cell_from_bytes(std::span<const std::byte> bytes);

}  // namespace calibrd::sim
