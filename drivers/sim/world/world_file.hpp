// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/base/result.hpp"
#include "drivers/sim/world/cell.hpp"
#include "drivers/sim/world/state.hpp"

namespace calibrd::sim {

/// Name of the environment variable that tells the OpenNI2 driver which world to look into.
inline constexpr const char* kWorldVariable = "CALIBRD_SIM_WORLD";

struct SharedWorld;

/// The simulator's end of the shared world: a mapped file that holds the cell once and the state under a
/// sequence lock, so that readers in other processes never block the writer and never see half a change. One
/// thread.
class WorldFile {
 public:
  /// Replaces the file at `path`, unless a living simulator owns it. Errors: world_unwritable, world_in_use.
  static Result<WorldFile> create(const std::filesystem::path& path, const Cell& cell,
                                  const WorldState& state);
  ~WorldFile();
  WorldFile(WorldFile&&) noexcept;
  WorldFile& operator=(WorldFile&&) = delete;

  void publish(const WorldState& state);
  /// Says that the simulator lives. Readers take a world without a beat for kBeatLost as gone.
  void beat(std::int64_t now_ns);

 private:
  WorldFile() = default;
  std::filesystem::path path_;
  int file_ =
      -1;  // holds the lock that says the file is owned; the system lets go of it when the process dies
  SharedWorld* shared_ = nullptr;
  std::size_t size_ = 0;
};

/// A reader's end. read() and alive() may be called from any thread.
class WorldView {
 public:
  /// Errors: world_unreadable, world_mismatch.
  static Result<WorldView> open(const std::filesystem::path& path);
  ~WorldView();
  WorldView(WorldView&&) noexcept;
  WorldView& operator=(WorldView&&) = delete;

  const Cell& cell() const { return *cell_; }
  /// The state as last published; nothing when the writer died in the middle of a change.
  std::optional<WorldState> read() const;
  bool alive(std::int64_t now_ns) const;

 private:
  WorldView() = default;
  std::unique_ptr<Cell> cell_;
  const SharedWorld* shared_ = nullptr;
  std::size_t size_ = 0;
};

inline constexpr std::int64_t kBeatLost_ns = 2'000'000'000;

}  // namespace calibrd::sim
