// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "api/problem/api_error.hpp"

namespace calibrd::api {

/// Looks at the bytes of a request's header as they come, before any parser does, and lets through only what
/// RFC 9112 calls well formed and what all readers understand alike: two that disagree on where a request
/// ends, or on which host it is for, can be played off against each other (request smuggling). No I/O.
class HeaderGate {
 public:
  enum class Verdict { read_more, passed, refused };

  /// `limit`: bytes of the whole header.
  explicit HeaderGate(std::size_t limit) : limit_(limit) {}

  /// `bytes`: everything since the first byte of the request. Each byte is looked at once, whatever the
  /// pieces it comes in.
  Verdict look(std::string_view bytes);

  /// Bytes of the header with its empty line; once it has passed.
  std::size_t size() const { return line_begin_; }
  /// Why it was refused, in words of ours alone: nothing of the request is in it.
  const Error& refusal() const { return refusal_; }

 private:
  Verdict refuse(ApiError error, const char* detail);
  const char* take_byte(unsigned char byte);
  const char* take_line(std::string_view line);
  const char* take_request_line(std::string_view line);
  const char* take_field(std::string_view line);
  const char* take_value(std::size_t which, std::string_view value) const;
  const char* take_end() const;

  static constexpr std::size_t kSingles = 8;
  const std::size_t limit_;
  std::size_t looked_ = 0, line_begin_ = 0, lines_ = 0;
  bool after_return_ = false, is_1_0_ = false;
  std::array<int, kSingles> counts_{};  ///< how often each header that may stand but once has come
  Error refusal_;
};

/// What is wrong with a request's target ("/path?query"); null when nothing is. Dots, slashes and control
/// characters hidden behind percent signs are wrong: what stands between might read them otherwise.
const char* fault_of_target(std::string_view target);

}  // namespace calibrd::api
