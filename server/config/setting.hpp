// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "server/config/config.hpp"
#include "server/config/raw_value.hpp"

namespace calibrd {

/// What the stars of a setting's path stand for, in order: {"kinect2"} for sensors.*.fx.
using Names = std::vector<std::string>;

/// One key of the configuration, declared once: reading, checking, printing and documentation all come from
/// here.
struct Setting {
  std::vector<std::string> path;  ///< {"sensors", "*", "fx"}
  std::string type;
  std::string unit;
  std::string meaning;
  bool required = false;
  bool live = false;  ///< a running daemon takes it over when it reads the configuration again
  std::function<Status(Config&, const Names&, const RawValue&)> set;
  std::function<std::string(const Config&, const Names&)> toml;  ///< its value; empty when it is not set
};

/// Every setting, in the order they are printed and documented.
const std::vector<Setting>& settings_table();

/// The names that stand for the stars of the setting in this configuration: one empty Names for a path
/// without stars.
std::vector<Names> instances(const Setting& setting, const Config& config);

/// The path with the stars replaced.
std::vector<std::string> path_of(const Setting& setting, const Names& names);

}  // namespace calibrd
