// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/print_config.hpp"

#include <algorithm>
#include <cctype>
#include <map>

#include "server/config/quoted.hpp"
#include "server/config/setting.hpp"

namespace calibrd {
namespace {

constexpr const char* kReferenceHead = R"(# Configuration

`calibrd serve --config FILE` reads one TOML file. What stands further down wins:

1. the defaults below,
2. the file,
3. the environment: `CALIBRD_SECTION__KEY`, for example `CALIBRD_SERVER__PORT=8081`, `CALIBRD_SENSORS__KINECT2__FX=365.5`,
4. the command line: `--set section.key=value`, for example `--set server.port=8081`.

A key that does not exist, or a value of the wrong type or range, stops the start with exit status 2; the message names
the line and the nearest name. `calibrd serve --check-config` only checks. `--print-config` prints the configuration in
effect, and where each value came from. Relative paths in a file are relative to that file.

On SIGHUP a running daemon reads it all again. It applies the keys marked *live*, and names in its log those that have changed and take a
restart; a configuration that cannot be used changes nothing.

`NAME` is a joint of the robot model (of `motion.routes` a name of your choice), `ID` a name of your choice for a sensor; a table may be given for any number of them.
This page is generated: `calibrd config-reference > docs/configuration.md`.
)";

std::string toml_key(const std::string& part) {
  const bool bare = !part.empty() && std::all_of(part.begin(), part.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '-' || c == '_';
  });
  return bare ? part : quoted(part);
}

/// "sensors.kinect2" of "sensors.kinect2.fx".
std::string section_of(const std::vector<std::string>& path) {
  std::string section;
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    section.append(i == 0 ? "" : ".").append(toml_key(path[i]));
  return section;
}

/// The path as the documentation shows it: sensors.ID, sensors.ID.workspace.POINT,
/// robot.joints.NAME.coupling.OTHER.
std::vector<std::string> documented_path(const Setting& setting) {
  const std::string first = setting.path.front() == "sensors" ? "ID" : "NAME";
  return path_of(setting, {first, first == "ID" ? "POINT" : "OTHER"});
}

std::string documented_default(const Setting& setting) {
  static const Config defaults;
  const auto value = setting.toml(defaults, {"ID", "OTHER"});
  if (setting.required) return "**required**";
  return value.empty() ? "" : "`" + value + "`";
}

std::string in_table_cell(std::string text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

/// Where a value came from. The name of a variable may hold anything.
std::string comment(std::string origin) {
  std::replace_if(
      origin.begin(), origin.end(), [](unsigned char c) { return std::iscntrl(c); }, ' ');
  return "  # " + origin;
}

}  // namespace

std::string config_as_toml(const LoadedConfig& loaded) {
  std::vector<std::string> order;
  std::map<std::string, std::string> sections;
  for (const auto& setting : settings_table()) {
    for (const auto& names : instances(setting, loaded.config)) {
      const auto path = path_of(setting, names);
      const auto value = setting.toml(loaded.config, names);
      if (value.empty()) continue;
      const auto section = section_of(path);
      if (!sections.contains(section)) order.push_back(section);
      const auto origin = loaded.origins.find(join_path(path));
      sections[section] += toml_key(path.back()) + " = " + value +
                           (origin == loaded.origins.end() ? "" : comment(origin->second)) + "\n";
    }
  }
  std::string text;
  for (const auto& section : order) text += "[" + section + "]\n" + sections[section] + "\n";
  return text;
}

std::string config_reference() {
  std::string page = kReferenceHead;
  std::string open_section;
  for (const auto& setting : settings_table()) {
    const auto path = documented_path(setting);
    if (const auto section = section_of(path); section != open_section) {
      open_section = section;
      page += "\n## [" + section + "]\n\n| key | type | unit | default | meaning |\n|---|---|---|---|---|\n";
    }
    page += "| `" + path.back() + "` | " + in_table_cell(setting.type) + " | " + setting.unit + " | " +
            in_table_cell(documented_default(setting)) + " | " + in_table_cell(setting.meaning) +
            (setting.live ? " *live*" : "") + " |\n";
  }
  return page;
}

}  // namespace calibrd
