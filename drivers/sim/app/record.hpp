// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/sim/scenes/simulate_capture.hpp"

namespace calibrd::sim {

struct RecordOptions {
  std::filesystem::path folder;
  std::vector<std::filesystem::path> urdfs;   ///< of several, the seed chooses one
  std::vector<std::filesystem::path> models;  ///< folders with packages
  std::string urdf_reference;                 ///< what capture.json says; empty: the URDF's absolute path
  std::uint64_t seed = 1;
  std::uint64_t scenes = 1;  ///< more than one: folders scene_SEED below `folder`
  CaptureOptions capture;
  bool distorted = false;  ///< with the lens of a real Kinect v2
};

/// Records random cells into capture/1 folders.
Status record_captures(const RecordOptions& options);

}  // namespace calibrd::sim
