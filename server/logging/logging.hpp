// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "server/config/config.hpp"

namespace spdlog {
class formatter;
}

namespace calibrd {

/// Sends the log of the whole process to stderr: as text, or as one JSON object per line
/// {"time": RFC 3339 UTC, "level": …, "message": …}. Call it before any thread logs.
void start_logging(const LogConfig& config);

/// Writes a log message as one line of JSON. The message is taken for UTF-8.
std::unique_ptr<spdlog::formatter> json_line_formatter();

}  // namespace calibrd
