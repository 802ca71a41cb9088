// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/descriptor_limit.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

namespace calibrd {
namespace {

/// The limits of this process are as they were when a test ends.
class DescriptorLimit : public testing::Test {
 protected:
  DescriptorLimit() { ::getrlimit(RLIMIT_NOFILE, &before_); }
  ~DescriptorLimit() override { ::setrlimit(RLIMIT_NOFILE, &before_); }
  void lower(rlim_t soft) {
    const rlimit limit{soft, before_.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &limit), 0);
  }
  static rlim_t soft() {
    rlimit limit{};
    ::getrlimit(RLIMIT_NOFILE, &limit);
    return limit.rlim_cur;
  }
  rlimit before_{};
};

TEST_F(DescriptorLimit, IsRaisedForManyConnections) {
  lower(600);
  EXPECT_EQ(make_room_for_connections(300), 300);
  EXPECT_EQ(soft(), 812U);
}

TEST_F(DescriptorLimit, IsLeftAloneWhereItIsEnough) {
  lower(1000);
  EXPECT_EQ(make_room_for_connections(64), 64);
  EXPECT_EQ(soft(), 1000U);
}

TEST_F(DescriptorLimit, WhatTheSystemDoesNotAllowIsTold) {
  if (before_.rlim_max == RLIM_INFINITY) GTEST_SKIP() << "there is no hard limit";
  EXPECT_EQ(make_room_for_connections(static_cast<int>(before_.rlim_max)),
            static_cast<int>(before_.rlim_max) - 512);
}

}  // namespace
}  // namespace calibrd
