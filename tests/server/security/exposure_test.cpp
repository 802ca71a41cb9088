// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/security/exposure.hpp"

#include <gtest/gtest.h>

#include "server/security/security_error.hpp"

namespace calibrd {
namespace {

TEST(Exposure, OnlyTheLoopbackIsListenedToWithoutTokens) {
  ServerConfig server;
  for (const auto* own : {"127.0.0.1", "127.1.2.3", "::1"}) {
    server.address = own;
    EXPECT_TRUE(check_exposure(server)) << own;
  }
  for (const auto* reached : {"0.0.0.0", "::", "192.168.1.7"}) {
    server.address = reached;
    server.tokens_file.clear();
    server.allow_unauthenticated = false;
    const auto refused = check_exposure(server);
    ASSERT_FALSE(refused) << reached;
    EXPECT_EQ(refused.error().code, SecurityError::open_without_tokens);
    EXPECT_NE(refused.error().message().find(reached), std::string::npos);
    server.allow_unauthenticated = true;
    EXPECT_TRUE(check_exposure(server));
    server.allow_unauthenticated = false;
    server.tokens_file = "/etc/calibrd/tokens.json";
    EXPECT_TRUE(check_exposure(server));
  }
}

}  // namespace
}  // namespace calibrd
