// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/security/token.hpp"

#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <openssl/sha.h>

#include <algorithm>
#include <cctype>
#include <charconv>

#include "server/security/security_error.hpp"

namespace calibrd {
namespace {

constexpr std::string_view kBase64Url = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

std::string base64url(const unsigned char* bytes, std::size_t count) {
  std::string text;
  unsigned pending = 0;
  int bits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    pending = (pending << 8U) | bytes[i];
    for (bits += 8; bits >= 6; bits -= 6)
      text += kBase64Url[(pending >> static_cast<unsigned>(bits - 6)) & 63U];
  }
  if (bits > 0) text += kBase64Url[(pending << static_cast<unsigned>(6 - bits)) & 63U];
  return text;
}

}  // namespace

Result<std::string> new_token() {
  std::array<unsigned char, 32> bits{};
  if (RAND_bytes(bits.data(), static_cast<int>(bits.size())) != 1)
    return Error{SecurityError::no_randomness, {}};
  auto token = "calibrd_" + base64url(bits.data(), bits.size());
  OPENSSL_cleanse(bits.data(), bits.size());
  return token;
}

TokenDigest digest_of(std::string_view token) {
  TokenDigest digest{};
  SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), digest.data());
  return digest;
}

bool is_same(const TokenDigest& a, const TokenDigest& b) {
  return CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

std::string hex_text(const TokenDigest& digest) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const unsigned byte : digest) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
  return text;
}

Result<TokenDigest> digest_of_hex(std::string_view hex) {
  TokenDigest digest{};
  if (hex.size() != 2 * digest.size()) return Error{SecurityError::tokens_malformed, "sha256"};
  for (std::size_t i = 0; i < digest.size(); ++i) {
    const char* begin = hex.data() + 2 * i;
    if (std::from_chars(begin, begin + 2, digest[i], 16).ptr != begin + 2)
      return Error{SecurityError::tokens_malformed, "sha256"};
  }
  return digest;
}

Status check_token_name(const std::string& name) {
  constexpr std::size_t kLongest = 64;
  const bool fits = !name.empty() && name.size() <= kLongest && name != "local" &&
                    std::all_of(name.begin(), name.end(), [](unsigned char c) {
                      return std::isalnum(c) || c == '-' || c == '_' || c == '.';
                    });
  if (!fits) return Error{SecurityError::bad_token_name, name};
  return Done{};
}

}  // namespace calibrd
