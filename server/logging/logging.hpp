// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>

#include "server/config/config.hpp"

namespace spdlog {
class formatter;
}

namespace calibrd {

/// Sends the log of the whole process to stderr: as text, or as one JSON object per line
/// {"time": RFC 3339 UTC, "level": …, "message": …} with "request_id" and "job_id" where the line belongs to
/// one (see LogScope). Call it before any thread logs.
void start_logging(const LogConfig& config);

/// The newest lines of the log, as they were written to stderr: see LogRing. Empty before start_logging().
std::string newest_log_lines();

/// From now on, at any time.
void set_log_level(const std::string& level);

/// Writes a log message as one line of JSON. The message is taken for UTF-8. It reads the marks of the thread
/// it is called on, which must be the one that logs.
std::unique_ptr<spdlog::formatter> json_line_formatter();

/// The same for people: the marks stand in brackets at the end.
std::unique_ptr<spdlog::formatter> text_line_formatter();

}  // namespace calibrd
