// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/config_changes.hpp"

#include <gtest/gtest.h>

#include "server/config/setting.hpp"

namespace calibrd {
namespace {

Config changed() {
  Config config;
  config.server.rate_limit = 1;
  config.server.loopback_rate_limit = 1;
  config.server.max_connections = 1;
  config.server.hosts = {"cell7"};
  config.server.tls = {"a", "b", "c", "d"};
  config.server.port = 1;
  config.log.level = "debug";
  config.drift.tolerance_mm = 2;
  config.sensors["eye"].fps = 5;
  return config;
}

bool holds(const std::vector<std::string>& keys, const std::string& key) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

TEST(ConfigChanges, AreNamedAsLiveOrNot) {
  const auto changes = changes_between(Config(), changed());
  EXPECT_TRUE(holds(changes.live, "server.rate_limit"));
  EXPECT_TRUE(holds(changes.live, "server.tls.certificate"));
  for (const auto* key : {"server.port", "drift.tolerance_mm", "sensors.eye.fps"})
    EXPECT_TRUE(holds(changes.restart, key)) << key;
  const auto none = changes_between(changed(), changed());
  EXPECT_TRUE(none.live.empty() && none.restart.empty());
  EXPECT_TRUE(holds(changes_between(changed(), Config()).restart, "sensors.eye.fps"))
      << "a sensor that is gone";
}

TEST(ConfigChanges, WhatIsMarkedLiveIsWhatIsTakenOver) {
  const auto now = with_live_keys(Config(), changed());
  EXPECT_TRUE(changes_between(now, changed()).live.empty());
  EXPECT_TRUE(changes_between(now, Config()).restart.empty());
  std::size_t live = 0;
  for (const auto& setting : settings_table()) live += setting.live ? 1 : 0;
  EXPECT_EQ(changes_between(Config(), changed()).live.size(), live) << "a live key is not tried here";
}

}  // namespace
}  // namespace calibrd
