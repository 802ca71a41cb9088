// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/result.hpp"

namespace calibrd {

/// A configured value before its setting gives it a type.
struct RawValue {
  std::variant<std::string, bool, std::int64_t, double, std::vector<RawValue>> data;
  std::optional<std::string> text;  ///< as written, where it came from the environment or the command line
  bool is_empty_table = false;      ///< a section without keys
  std::filesystem::path folder;     ///< what a relative path in it is relative to
};

/// One key = value of one source.
struct RawEntry {
  std::vector<std::string> path;  ///< {"sensors", "kinect2", "fx"}
  RawValue value;
  std::string origin;  ///< "calibrd.toml:12", "CALIBRD_SERVER__PORT" or "--set server.port"
};

/// Every key of a TOML file, in the order of its lines. Errors: ConfigError::file_unreadable, not_toml (with
/// line).
Result<std::vector<RawEntry>> read_toml_file(const std::filesystem::path& file);

/// A value given as text: TOML where it is TOML (8080, true, [1, 2]), else a string.
RawValue parse_text_value(const std::string& text);

/// "sensors.kinect2.fx"
std::string join_path(const std::vector<std::string>& path);
std::vector<std::string> split_path(std::string_view dotted);

}  // namespace calibrd
