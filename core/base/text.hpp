// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace calibrd {

/// The bytes that may follow the first of a UTF-8 sequence: how many, and the bounds of the first of them.
/// They leave out what UTF-8 forbids: overlong forms, surrogates, and what is beyond U+10FFFF.
struct Utf8Tail {
  bool allowed = true;
  std::size_t length = 0;
  unsigned char least = 0x80, most = 0xbf;

  static constexpr Utf8Tail after(unsigned char lead) {
    if (lead < 0x80) return {};
    if (lead < 0xc2 || lead > 0xf4) return {false};
    if (lead < 0xe0) return {true, 1};
    if (lead == 0xe0) return {true, 2, 0xa0};
    if (lead == 0xed) return {true, 2, 0x80, 0x9f};
    if (lead < 0xf0) return {true, 2};
    if (lead == 0xf0) return {true, 3, 0x90};
    return lead == 0xf4 ? Utf8Tail{true, 3, 0x80, 0x8f} : Utf8Tail{true, 3};
  }
};

/// What is not UTF-8 can stand neither in JSON nor in TOML.
inline bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const auto tail = Utf8Tail::after(static_cast<unsigned char>(text.front()));
    text.remove_prefix(1);
    if (!tail.allowed || tail.length > text.size()) return false;
    for (std::size_t i = 0; i < tail.length; ++i) {
      const auto byte = static_cast<unsigned char>(text[i]);
      if (byte < (i == 0 ? tail.least : 0x80) || byte > (i == 0 ? tail.most : 0xbf)) return false;
    }
    text.remove_prefix(tail.length);
  }
  return true;
}

/// UTF-8 text of at most `bytes` bytes and `ending`; the text itself when it is no longer than that. No
/// character is cut through: half a character makes a whole JSON answer unreadable.
inline std::string shortened(std::string text, std::size_t bytes, const char* ending) {
  if (text.size() <= bytes) return text;
  while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xc0U) == 0x80U) --bytes;
  return text.substr(0, bytes) + ending;
}

}  // namespace calibrd
