// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/stray_character.hpp"

#include <algorithm>
#include <array>

namespace calibrd {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kTripleBasic = "\"\"\"";
constexpr std::string_view kEndOfComment = "\n";

/// What ends the comment or the quote that begins here; empty when neither does.
std::string_view end_of_what_begins(std::string_view rest) {
  constexpr std::array<std::string_view, 4> kQuotes{kTripleBasic, "'''", "\"", "'"};
  if (rest.front() == '#') return kEndOfComment;
  const auto* const quote =
      std::find_if(kQuotes.begin(), kQuotes.end(), [&](auto mark) { return rest.starts_with(mark); });
  return quote == kQuotes.end() ? std::string_view() : *quote;
}

/// Two more quotes before the closing three belong to the text: """" ends once.
std::size_t length_of_end(std::string_view rest, std::string_view end) {
  if (end.size() < 3) return end.size();
  const auto other = std::min(rest.find_first_not_of(end.front()), rest.size());
  return std::min(other, std::size_t{5});
}

class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {
    if (text_.starts_with(kByteOrderMark)) text_.remove_prefix(kByteOrderMark.size());
  }

  std::optional<std::size_t> find() {
    while (!text_.empty()) {
      const bool is_ascii = static_cast<unsigned char>(text_.front()) < 0x80;
      if (!is_ascii && (end_.empty() || end_ == kTripleBasic)) return line_;
      step();
    }
    return std::nullopt;
  }

 private:
  void step() {
    const bool is_one_line = end_.size() == 1;
    if (end_.empty()) {
      end_ = end_of_what_begins(text_);
      skip(end_ == kEndOfComment ? 1 : std::max<std::size_t>(end_.size(), 1));
    } else if (end_.front() == '"' && (text_.starts_with("\\\"") || text_.starts_with("\\\\"))) {
      skip(2);
    } else if (text_.starts_with(end_)) {
      skip(length_of_end(text_, end_));
      end_ = {};
    } else {
      if (is_one_line && text_.front() == '\n') end_ = {};
      skip(1);
    }
  }
  void skip(std::size_t count) {
    line_ += static_cast<std::size_t>(
        std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(count), '\n'));
    text_.remove_prefix(count);
  }

  std::string_view text_;
  std::string_view end_;  // of the comment or quote we are in
  std::size_t line_ = 1;
};

}  // namespace

std::optional<std::size_t> line_of_stray_character(std::string_view toml) { return Scanner(toml).find(); }

}  // namespace calibrd
