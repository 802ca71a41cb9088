// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/print_config.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "server/config/setting.hpp"

namespace calibrd {
namespace {

TEST(PrintConfig, ReferencePageIsUpToDate) {
  std::stringstream page;
  page << std::ifstream(CALIBRD_SOURCE_DIR "/docs/configuration.md").rdbuf();
  EXPECT_EQ(page.str(), config_reference()) << "run: calibrd config-reference > docs/configuration.md";
}

TEST(PrintConfig, WhatIsPrintedReadsBackTheSame) {
  const auto folder = std::filesystem::temp_directory_path() / ("calibrd_print_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto first =
      load_config({std::nullopt,
                   {},
                   {"robot.urdf=/r.urdf", "robot.host=a\tb\"c\\d\x01", "robot.joints.odd\nname.axis=1",
                    "sensors.k.fx=365.5", "sensors.k.fy=1", "sensors.k.cx=2", "sensors.k.cy=3",
                    "sensors.k.guess=[1,2,3,0,0,0,1]", "sensors.k.workspace.tray=[0.4,-0.2,0.1]",
                    "robot.joints.j1.coupling.j0=0.5", "pose.max_unverified=90s",
                    "motion.routes.tour.postures_deg=[[0, 20.5], [10, -25]]"}});
  ASSERT_TRUE(first) << first.error().message();
  std::ofstream(folder / "printed.toml") << config_as_toml(*first);
  const auto second = load_config({folder / "printed.toml", {}, {}});
  ASSERT_TRUE(second) << second.error().message();
  const auto value_lines = [](const std::string& toml) {
    std::string lines, line;
    for (std::istringstream stream(toml); std::getline(stream, line);)
      lines += line.substr(0, line.find("  #")) + "\n";
    return lines;
  };
  EXPECT_EQ(value_lines(config_as_toml(*first)), value_lines(config_as_toml(*second)));
  EXPECT_EQ(second->config.motion.routes.at("tour").postures_deg,
            (std::vector<std::vector<double>>{{0, 20.5}, {10, -25}}));
  EXPECT_NE(config_as_toml(*first).find("fx = 365.5  # --set sensors.k.fx"), std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST(PrintConfig, EverySettingHasATypeAndAMeaning) {
  for (const auto& setting : settings_table()) {
    EXPECT_FALSE(setting.type.empty()) << join_path(setting.path);
    EXPECT_FALSE(setting.meaning.empty()) << join_path(setting.path);
  }
}

}  // namespace
}  // namespace calibrd
