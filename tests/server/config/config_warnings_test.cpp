// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/config_warnings.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

Config with_camera(double cx, double cy, double k1) {
  Config config;
  config.sensors["eye"].camera = {512, 424, 365, 365, cx, cy, {k1, 0, 0, 0, 0}};
  return config;
}

TEST(ConfigWarnings, MeasuredIntrinsicsGiveNone) {
  EXPECT_TRUE(config_warnings(with_camera(254.9, 205.4, 0.09)).empty());
}

TEST(ConfigWarnings, PrincipalPointAtTheCentreByEitherConventionLooksLikeADefault) {
  for (const auto& [cx, cy] : {std::pair{255.5, 211.5}, std::pair{256.0, 212.0}}) {
    const auto warnings = config_warnings(with_camera(cx, cy, 0.09));
    ASSERT_EQ(warnings.size(), 1U) << cx;
    EXPECT_EQ(warnings[0].find("sensors.eye: cx and cy"), 0U) << warnings[0];
  }
  EXPECT_TRUE(config_warnings(with_camera(255.5, 205.4, 0.09)).empty())
      << "one of two may be there by chance";
}

TEST(ConfigWarnings, NoDistortionAtAllLooksLikeADefault) {
  const auto warnings = config_warnings(with_camera(254.9, 205.4, 0));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].find("sensors.eye: distortion"), 0U) << warnings[0];
}

TEST(ConfigWarnings, MotionThatAnybodyOnTheNetworkCanAskForIsNamed) {
  auto config = with_camera(254.9, 205.4, 0.09);
  config.motion.enabled = true;
  EXPECT_TRUE(config_warnings(config).empty());
  config.server.address = "0.0.0.0";
  ASSERT_EQ(config_warnings(config).size(), 2U);
  EXPECT_EQ(config_warnings(config)[0].find("server.allow_unauthenticated"), 0U);
  EXPECT_EQ(config_warnings(config)[1].find("motion.enabled"), 0U);
  config.motion.enabled = false;
  EXPECT_EQ(config_warnings(config).size(), 1U);
  config.server.tokens_file = "/etc/calibrd/tokens.json";
  EXPECT_TRUE(config_warnings(config).empty());
}

}  // namespace
}  // namespace calibrd
