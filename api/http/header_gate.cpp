// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/header_gate.hpp"

#include <algorithm>
#include <cctype>

#include "api/http/host_rules.hpp"

namespace calibrd::api {
namespace {

constexpr std::size_t kMaxFields = 64;
constexpr std::size_t kMaxLengthDigits = 12;

/// Headers that may stand but once: which of two counts would be anybody's guess.
constexpr std::array<std::string_view, 8> kSingle{"host",          "content-length", "transfer-encoding",
                                                  "authorization", "origin",         "content-type",
                                                  "expect",        "idempotency-key"};
enum Place : std::size_t { kHost, kLength, kEncoding };

bool is_token_character(unsigned char c) {
  return std::isalnum(c) != 0 ||
         std::string_view("!#$%&'*+-.^_`|~").find(static_cast<char>(c)) != std::string_view::npos;
}

bool is_token(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), is_token_character);
}

bool is_equal(std::string_view text, std::string_view lower_case) {
  return std::equal(text.begin(), text.end(), lower_case.begin(), lower_case.end(),
                    [](unsigned char a, char b) { return std::tolower(a) == b; });
}

std::string_view trimmed(std::string_view value) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!value.empty() && is_blank(value.front())) value.remove_prefix(1);
  while (!value.empty() && is_blank(value.back())) value.remove_suffix(1);
  return value;
}

}  // namespace

HeaderGate::Verdict HeaderGate::look(std::string_view bytes) {
  for (; looked_ < bytes.size(); ++looked_) {
    if (looked_ >= limit_) return refuse(ApiError::header_too_large, "");
    if (const char* fault = take_byte(static_cast<unsigned char>(bytes[looked_])))
      return refuse(ApiError::bad_request, fault);
    if (bytes[looked_] != '\n') continue;
    const auto line = bytes.substr(line_begin_, looked_ - 1 - line_begin_);
    line_begin_ = looked_ + 1;
    const bool is_end = line.empty() && lines_ > 0;
    if (const char* fault = is_end ? take_end() : take_line(line))
      return refuse(ApiError::bad_request, fault);
    if (lines_ > kMaxFields) return refuse(ApiError::header_too_large, "more than 64 header lines");
    if (is_end) return Verdict::passed;
  }
  return Verdict::read_more;
}

HeaderGate::Verdict HeaderGate::refuse(ApiError error, const char* detail) {
  refusal_ = fail(error, detail);
  return Verdict::refused;
}

const char* HeaderGate::take_byte(unsigned char byte) {
  if (after_return_ != (byte == '\n')) return "a line must end with CR LF, and neither may stand alone";
  after_return_ = byte == '\r';
  if (after_return_ || byte == '\n') return nullptr;
  if (byte == 0x7f || (byte < 0x20 && byte != '\t')) return "a control character in the header";
  if (lines_ == 0 && (byte == '\t' || byte > 0x7f)) return "the first line holds what is no visible ASCII";
  return nullptr;
}

const char* HeaderGate::take_line(std::string_view line) {
  return lines_++ == 0 ? take_request_line(line) : take_field(line);
}

const char* HeaderGate::take_request_line(std::string_view line) {
  constexpr std::size_t kLongestMethod = 16;
  const auto method_end = line.find(' ');
  const auto target_end = line.rfind(' ');
  if (method_end == std::string_view::npos || method_end == target_end)
    return "the first line is not METHOD /path HTTP/1.1";
  const auto method = line.substr(0, method_end);
  const auto version = line.substr(target_end + 1);
  if (!is_token(method) || method.size() > kLongestMethod) return "the method is none";
  is_1_0_ = version == "HTTP/1.0";
  if (version != "HTTP/1.1" && !is_1_0_) return "the version is not HTTP/1.1";
  return fault_of_target(line.substr(method_end + 1, target_end - method_end - 1));
}

const char* HeaderGate::take_field(std::string_view line) {
  if (line.front() == ' ' || line.front() == '\t') return "a header goes on in the next line";
  const auto colon = line.find(':');
  if (colon == std::string_view::npos) return "a header line without a colon";
  const auto name = line.substr(0, colon);
  if (!is_token(name)) return "the name of a header is none";
  const auto found =
      std::find_if(kSingle.begin(), kSingle.end(), [&](auto single) { return is_equal(name, single); });
  if (found == kSingle.end()) return nullptr;
  const auto which = static_cast<std::size_t>(found - kSingle.begin());
  if (++counts_[which] > 1) return "a header that may stand but once stands twice";
  return take_value(which, trimmed(line.substr(colon + 1)));
}

const char* HeaderGate::take_value(std::size_t which, std::string_view value) const {
  if (which == kHost && !parse_authority(value)) return "the Host header is no name or address";
  if (which == kLength) {
    const bool is_number = !value.empty() && std::all_of(value.begin(), value.end(),
                                                         [](unsigned char c) { return std::isdigit(c); });
    if (!is_number || value.size() > kMaxLengthDigits) return "the Content-Length is no number of bytes";
  }
  if (which == kEncoding && !is_equal(value, "chunked")) return "the only Transfer-Encoding known is chunked";
  return nullptr;
}

const char* HeaderGate::take_end() const {
  if (counts_[kHost] != 1) return "the Host header is missing";
  if (counts_[kEncoding] > 0 && counts_[kLength] > 0) return "Content-Length and Transfer-Encoding at once";
  if (counts_[kEncoding] > 0 && is_1_0_) return "HTTP/1.0 knows no Transfer-Encoding";
  return nullptr;
}

}  // namespace calibrd::api
