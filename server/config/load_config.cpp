// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/load_config.hpp"

#include <unistd.h>

#include <algorithm>
#include <cctype>

#include "core/base/text.hpp"
#include "core/robot/nearest_name.hpp"
#include "drivers/robot/robot_drivers.hpp"
#include "server/config/config_error.hpp"
#include "server/config/setting.hpp"

namespace calibrd {
namespace {

constexpr std::string_view kEnvironmentPrefix = "CALIBRD_";

/// The path begins as the setting's, whose stars stand for any name.
bool begins_like(const std::vector<std::string>& path, const Setting& setting) {
  return path.size() <= setting.path.size() &&
         std::equal(path.begin(), path.end(), setting.path.begin(),
                    [](const auto& part, const auto& wanted) { return wanted == "*" || part == wanted; });
}

bool matches(const Setting& setting, const std::vector<std::string>& path) {
  return path.size() == setting.path.size() && begins_like(path, setting);
}

Names names_in(const Setting& setting, const std::vector<std::string>& path) {
  Names names;
  for (std::size_t i = 0; i < path.size(); ++i)
    if (setting.path[i] == "*") names.push_back(path[i]);
  return names;
}

/// Where a key stands and which it is; an option of the command line says both by itself.
std::string place(const RawEntry& entry) {
  const auto path = join_path(entry.path);
  return entry.origin.ends_with(" " + path) ? entry.origin : entry.origin + ": " + path;
}

/// Known names for the first part of the path that no setting has: what a misspelt key may have meant.
Error unknown_key(const RawEntry& entry) {
  std::vector<const Setting*> left;
  for (const auto& setting : settings_table()) left.push_back(&setting);
  for (std::size_t i = 0; i < entry.path.size(); ++i) {
    std::vector<std::string> known;
    std::vector<const Setting*> next;
    for (const auto* setting : left) {
      if (i >= setting->path.size()) continue;
      const auto& part = setting->path[i];
      if (part == "*" || part == entry.path[i]) next.push_back(setting);
      if (part != "*" && std::find(known.begin(), known.end(), part) == known.end()) known.push_back(part);
    }
    if (next.empty()) {
      const auto hint = known.empty() ? std::string() : " (" + name_hint(entry.path[i], known) + ")";
      return Error{ConfigError::unknown_key, place(entry) + hint};
    }
    left = std::move(next);
  }
  return Error{ConfigError::unknown_key, place(entry) + " is a section, not a key"};
}

/// A section without keys counts: a sensor in it is there, and lacks what it needs.
Status enter_section(const RawEntry& entry, Config& config) {
  const auto& path = entry.path;
  const auto is_in_section = [&](const Setting& setting) {
    return path.size() < setting.path.size() && begins_like(path, setting);
  };
  if (std::none_of(settings_table().begin(), settings_table().end(), is_in_section))
    return unknown_key(entry);
  if (path.size() == 2 && path[0] == "sensors") config.sensors[path[1]];
  if (path.size() == 3 && path[1] == "joints") config.robot.joints[path[2]];
  if (path.size() == 3 && path[1] == "routes") config.motion.routes[path[2]];
  return Done{};
}

/// A file is UTF-8, or it is no TOML; variables and options may hold anything.
Status check_encoding(const RawEntry& entry) {
  if (is_utf8(join_path(entry.path)) && is_utf8(entry.value.text.value_or(""))) return Done{};
  return Error{ConfigError::bad_value, entry.origin + ": it is not UTF-8"};
}

Status apply(const RawEntry& entry, LoadedConfig& loaded) {
  if (auto status = check_encoding(entry); !status) return status;
  if (entry.value.is_empty_table) return enter_section(entry, loaded.config);
  const auto& table = settings_table();
  const auto setting =
      std::find_if(table.begin(), table.end(), [&](const auto& s) { return matches(s, entry.path); });
  if (setting == table.end()) return unknown_key(entry);
  const auto path = join_path(entry.path);
  if (auto status = setting->set(loaded.config, names_in(*setting, entry.path), entry.value); !status)
    return Error{status.error().code, place(entry) + ": " + status.error().detail};
  loaded.origins[path] = entry.origin;
  return Done{};
}

/// Environment names have no lower case and no dash: finds the sensor or joint that was meant.
void restore_case(std::vector<std::string>& path, const Config& config) {
  const auto plain = [](std::string name) {
    for (char& c : name) c = c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return name;
  };
  const auto restore = [&](std::string& part, const auto& known) {
    for (const auto& [name, unused] : known)
      if (plain(name) == part) part = name;
  };
  if (path.size() > 1 && path[0] == "sensors") restore(path[1], config.sensors);
  if (path.size() > 2 && path[0] == "robot" && path[1] == "joints") restore(path[2], config.robot.joints);
  if (path.size() > 2 && path[0] == "motion" && path[1] == "routes") restore(path[2], config.motion.routes);
}

/// The entry of "CALIBRD_SECTION__KEY=value"; nothing for any other variable.
std::optional<RawEntry> environment_entry(const std::string& variable, const Config& config) {
  const auto equals = variable.find('=');
  if (!variable.starts_with(kEnvironmentPrefix) || equals == std::string::npos) return std::nullopt;
  std::string name = variable.substr(kEnvironmentPrefix.size(), equals - kEnvironmentPrefix.size());
  if (name.find("__") == std::string::npos) return std::nullopt;
  RawEntry entry{{""}, parse_text_value(variable.substr(equals + 1)), variable.substr(0, equals)};
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (name.compare(i, 2, "__") == 0) {
      entry.path.emplace_back();
      ++i;
    } else {
      entry.path.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(name[i])));
    }
  }
  restore_case(entry.path, config);
  return entry;
}

Result<RawEntry> override_entry(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) return Error{ConfigError::bad_override, "--set " + text};
  const auto key = text.substr(0, equals);
  return RawEntry{split_path(key), parse_text_value(text.substr(equals + 1)), "--set " + key};
}

/// What depends on the driver, where nobody has set it.
void complete_robot(LoadedConfig& loaded) {
  RobotConfig& robot = loaded.config.robot;
  const RobotDriver* driver = find_robot_driver(robot.driver);
  if (driver == nullptr) return;
  if (!loaded.origins.contains("robot.port")) robot.port = driver->default_port;
  if (!loaded.origins.contains("robot.joint_count")) robot.joint_count = driver->max_joints;
}

Status check_required(const Config& config) {
  for (const auto& setting : settings_table()) {
    if (!setting.required) continue;
    for (const auto& names : instances(setting, config))
      if (setting.toml(config, names).empty())
        return Error{ConfigError::missing_key, join_path(path_of(setting, names))};
  }
  return Done{};
}

/// Sensor ids stand in URLs.
Status check_sensor_ids(const Config& config) {
  for (const auto& [id, unused] : config.sensors) {
    const bool fits = !id.empty() && id.size() <= 64 &&
                      std::all_of(id.begin(), id.end(),
                                  [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; });
    if (!fits)
      return Error{ConfigError::bad_value,
                   "sensors.\"" + id + "\": an id has 1 to 64 letters, digits, - and _"};
  }
  return Done{};
}

Status check_tls(const TlsConfig& tls) {
  const bool has_certificate = !tls.certificate.empty();
  if (has_certificate == !tls.key.empty() && (has_certificate || tls.client_ca.empty())) return Done{};
  return Error{ConfigError::bad_value,
               "server.tls.certificate and server.tls.key are needed together, and for client_ca both"};
}

Status check_whole(const Config& config) {
  if (auto status = check_tls(config.server.tls); !status) return status;
  if (auto status = check_required(config); !status) return status;
  if (auto status = check_sensor_ids(config); !status) return status;
  for (const auto& [id, sensor] : config.sensors)
    if (!sensor.uri.empty() && !sensor.oni_file.empty())
      return Error{ConfigError::bad_value,
                   "sensors." + id + ": uri and oni_file exclude each other; remove one"};
  return Done{};
}

}  // namespace

Result<LoadedConfig> load_config(const ConfigSources& sources) {
  LoadedConfig loaded;
  if (sources.file) {
    const auto entries = read_toml_file(*sources.file);
    if (!entries) return entries.error();
    for (const auto& entry : *entries)
      if (auto status = apply(entry, loaded); !status) return status.error();
  }
  for (const auto& variable : sources.environment)
    if (const auto entry = environment_entry(variable, loaded.config))
      if (auto status = apply(*entry, loaded); !status) return status.error();
  for (const auto& text : sources.overrides) {
    const auto entry = override_entry(text);
    if (!entry) return entry.error();
    if (auto status = apply(*entry, loaded); !status) return status.error();
  }
  complete_robot(loaded);
  if (auto status = check_whole(loaded.config); !status) return status.error();
  return loaded;
}

std::vector<std::string> process_environment() {
  std::vector<std::string> all;
  for (char** variable = environ; variable != nullptr && *variable != nullptr; ++variable)
    all.emplace_back(*variable);
  return all;
}

}  // namespace calibrd
