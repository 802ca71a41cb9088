// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "core/base/result.hpp"
#include "drivers/sim/model/description.hpp"
#include "drivers/sim/world/world_file.hpp"

namespace calibrd::sim {

/// The world while it runs: the simulator's own copy, and the file that shows it to the OpenNI2 driver. One
/// thread.
class LiveWorld {
 public:
  /// Errors: world_unwritable.
  static Result<LiveWorld> open(const World& world, const std::filesystem::path& world_file) {
    auto file = WorldFile::create(world_file, world.cell, world.state);
    if (!file) return file.error();
    return LiveWorld(world, std::move(*file));
  }

  const Cell& cell() const { return cell_; }
  const WorldState& state() const { return state_; }

  /// From now on the world is like this, for the controller and for all drivers.
  void change(const WorldState& state) {
    state_ = state;
    file_.publish(state_);
  }
  void beat() { file_.beat(monotonic_ns()); }

 private:
  LiveWorld(const World& world, WorldFile file)
      : cell_(world.cell), state_(world.state), file_(std::move(file)) {}

  Cell cell_;
  WorldState state_;
  WorldFile file_;
};

}  // namespace calibrd::sim
