// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>
#include <string_view>

#include "api/access/scope.hpp"
#include "core/base/result.hpp"

namespace calibrd {

/// SHA-256. A token is random enough that nothing slower is needed: no list of likely ones can be tried.
using TokenDigest = std::array<unsigned char, 32>;

/// What is kept of a token: not the token.
struct TokenEntry {
  std::string name;
  api::Scope scope = api::Scope::read;
  TokenDigest digest{};
  std::string created;  ///< RFC 3339, UTC
};

/// "calibrd_" and 256 random bits in base64url. Error: SecurityError::no_randomness.
Result<std::string> new_token();

TokenDigest digest_of(std::string_view token);

/// Compares in a time that does not depend on where they differ.
bool is_same(const TokenDigest& a, const TokenDigest& b);

std::string hex_text(const TokenDigest& digest);
/// Error: SecurityError::tokens_malformed.
Result<TokenDigest> digest_of_hex(std::string_view hex);

/// Done, or SecurityError::bad_token_name.
Status check_token_name(const std::string& name);

}  // namespace calibrd
