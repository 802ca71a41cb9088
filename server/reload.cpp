// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/reload.hpp"

#include <spdlog/spdlog.h>

#include "server/config/config_changes.hpp"
#include "server/logging/logging.hpp"

namespace calibrd {
namespace {

std::string list_of(const std::vector<std::string>& keys) {
  std::string list;
  for (const auto& key : keys) list.append(list.empty() ? "" : ", ").append(key);
  return list.empty() ? "none" : list;
}

void stay(Daemon& daemon, const Error& why) {
  spdlog::error("SIGHUP: the configuration stays as it was: {}", why.message());
  daemon.note_reload(false, why.message());
}

}  // namespace

void reload(const ConfigSources& sources, Daemon& daemon, Config& now) {
  const auto fresh = load_config(sources);
  if (!fresh) return stay(daemon, fresh.error());
  const auto changes = changes_between(now, fresh->config);
  Config next = with_live_keys(now, fresh->config);
  if (const auto status = daemon.apply(next); !status) return stay(daemon, status.error());
  set_log_level(next.log.level);
  now = std::move(next);
  daemon.note_reload(true, list_of(changes.live));
  spdlog::info(
      "SIGHUP: the configuration was read again, certificates and tokens too; changed keys applied: {}",
      list_of(changes.live));
  if (!changes.restart.empty())
    spdlog::warn("SIGHUP: these keys have changed and take a restart: {}", list_of(changes.restart));
}

}  // namespace calibrd
