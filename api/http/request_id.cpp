// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/request_id.hpp"

#include <algorithm>
#include <random>

namespace calibrd::api {
namespace {

constexpr std::size_t kLongest = 64;

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
         c == '-';
}

}  // namespace

bool is_request_id(std::string_view text) {
  return !text.empty() && text.size() <= kLongest && std::ranges::all_of(text, is_plain);
}

RequestIds::RequestIds() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::random_device random;
  auto bits = random();
  for (int i = 0; i < 6; ++i, bits >>= 4) run_ += kDigits[bits & 0xfU];
  run_ += '-';
}

std::string RequestIds::next() { return run_ + std::to_string(++last_); }

}  // namespace calibrd::api
