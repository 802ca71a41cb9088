// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/config_changes.hpp"

#include <algorithm>

#include "server/config/setting.hpp"

namespace calibrd {
namespace {

/// Names that either configuration has for the stars of the setting.
std::vector<Names> all_instances(const Setting& setting, const Config& old, const Config& fresh) {
  auto all = instances(setting, old);
  for (auto& names : instances(setting, fresh))
    if (std::find(all.begin(), all.end(), names) == all.end()) all.push_back(std::move(names));
  return all;
}

}  // namespace

ConfigChanges changes_between(const Config& old, const Config& fresh) {
  ConfigChanges changes;
  for (const auto& setting : settings_table())
    for (const auto& names : all_instances(setting, old, fresh))
      if (setting.toml(old, names) != setting.toml(fresh, names))
        (setting.live ? changes.live : changes.restart).push_back(join_path(path_of(setting, names)));
  return changes;
}

Config with_live_keys(const Config& old, const Config& fresh) {
  Config now = old;
  now.server.max_connections = fresh.server.max_connections;
  now.server.hosts = fresh.server.hosts;
  now.server.rate_limit = fresh.server.rate_limit;
  now.server.loopback_rate_limit = fresh.server.loopback_rate_limit;
  now.server.tls = fresh.server.tls;
  now.log.level = fresh.log.level;
  return now;
}

}  // namespace calibrd
