// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/robot_link_error.hpp"

#include <gtest/gtest.h>

namespace calibrd {
namespace {

TEST(RobotLinkError, SaysWhatToDoForEveryCode) {
  for (int code = 1; code <= static_cast<int>(RobotLinkError::outside_joint_range); ++code) {
    EXPECT_NE(make_error_code(static_cast<RobotLinkError>(code)).message(), "unknown robot link error")
        << code;
  }
}

TEST(RobotLinkError, ExplainsWhatTheOperatingSystemSays) {
  EXPECT_EQ(explain_connect_failure(std::make_error_code(std::errc::connection_refused)),
            RobotLinkError::refused);
  EXPECT_EQ(explain_connect_failure(std::make_error_code(std::errc::timed_out)), RobotLinkError::no_answer);
  EXPECT_EQ(explain_connect_failure(std::make_error_code(std::errc::host_unreachable)),
            RobotLinkError::unreachable);
  EXPECT_EQ(explain_connect_failure(std::make_error_code(std::errc::permission_denied)),
            RobotLinkError::connect_failed);
  EXPECT_EQ(explain_connect_failure(RobotLinkError::host_unknown), RobotLinkError::host_unknown);
}

}  // namespace
}  // namespace calibrd
