// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "core/base/result.hpp"

namespace calibrd {

/// The content of a regular file of at most `max_bytes`. Folders, pipes and devices are refused: opening a
/// pipe would wait for ever. Errors: CaptureError::unreadable, file_too_large.
Result<std::string> read_bytes(const std::filesystem::path& path, std::uintmax_t max_bytes);

/// Where `name`, a path that a recording states, lies in the recording's folder. A recording may come from
/// anywhere, so it cannot point out of its own folder. Errors: CaptureError::path_outside.
Result<std::filesystem::path> path_inside(const std::filesystem::path& folder, const std::string& name);

}  // namespace calibrd
