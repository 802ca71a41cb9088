// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

#include "core/base/result.hpp"
#include "drivers/sim/scenes/simulate_capture.hpp"

namespace calibrd::sim {

/// Writes the recording as a capture/1 folder, with truth.json beside capture.json. `urdf` is what
/// capture.json says of the robot's URDF. The folder must be absent or empty. Errors: capture_unwritable.
Status write_capture_folder(const std::filesystem::path& folder, const SimulatedCapture& capture,
                            const std::string& urdf);

}  // namespace calibrd::sim
