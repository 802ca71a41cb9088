// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <cctype>

#include "api/http/header_gate.hpp"

namespace calibrd::api {
namespace {

/// RFC 3986: what may stand in a path or query as it is, the percent sign left out.
bool is_plain(unsigned char c) {
  return std::isalnum(c) != 0 ||
         std::string_view("-._~!$&'()*+,;=:@/?").find(static_cast<char>(c)) != std::string_view::npos;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// The byte behind "%41"; -1 where there is none.
int escaped_byte(std::string_view text) {
  if (text.size() < 3) return -1;
  const int high = hex_digit(text[1]), low = hex_digit(text[2]);
  return high < 0 || low < 0 ? -1 : high * 16 + low;
}

/// Counts what a segment of the path is made of: "." and ".." are nothing but one or two dots.
struct Segment {
  int dots = 0, others = 0;
  void take(int byte) { ++(byte == '.' ? dots : others); }
  bool is_dots() const { return others == 0 && (dots == 1 || dots == 2); }
};

}  // namespace

const char* fault_of_target(std::string_view target) {
  constexpr const char* kDots = "the path holds . or .. as a part";
  if (target.empty() || target.front() != '/') return "the path does not begin with a slash";
  Segment segment;
  bool in_query = false;
  for (std::size_t i = 0; i < target.size(); ++i) {
    const bool is_escaped = target[i] == '%';
    const int byte = is_escaped ? escaped_byte(target.substr(i)) : static_cast<unsigned char>(target[i]);
    if (byte <= 0) return "a percent sign is not followed by two hexadecimal digits, or by 00";
    if (!is_escaped && !is_plain(static_cast<unsigned char>(byte)))
      return "the path holds a character that must be percent-encoded";
    if (is_escaped) i += 2;
    if (in_query) continue;
    const bool ends = !is_escaped && (byte == '/' || byte == '?');
    if (is_escaped && (byte == '/' || byte == '\\' || byte < 0x20 || byte == 0x7f))
      return "a slash or a control character is percent-encoded in the path";
    if (ends && segment.is_dots()) return kDots;
    ends ? void(segment = {}) : segment.take(byte);
    in_query = ends && byte == '?';
  }
  return !in_query && segment.is_dots() ? kDots : nullptr;
}

}  // namespace calibrd::api
