// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/json/doubled_key.hpp"

#include <boost/json/basic_parser_impl.hpp>
#include <set>
#include <vector>

namespace calibrd::api {
namespace {

namespace json = boost::json;

/// Hears of everything in a text; remembers the keys of the objects that are open.
struct Keys {
  static constexpr std::size_t max_object_size = static_cast<std::size_t>(-1);
  static constexpr std::size_t max_array_size = static_cast<std::size_t>(-1);
  static constexpr std::size_t max_key_size = static_cast<std::size_t>(-1);
  static constexpr std::size_t max_string_size = static_cast<std::size_t>(-1);
  using Code = boost::system::error_code;

  bool on_object_begin(Code&) {
    objects.emplace_back();
    return true;
  }
  bool on_object_end(std::size_t, Code&) {
    objects.pop_back();
    return true;
  }
  bool on_key_part(json::string_view part, std::size_t, Code&) {
    key.append(part);
    return true;
  }
  bool on_key(json::string_view part, std::size_t, Code&) {
    key.append(part);
    if (!objects.back().insert(key).second) doubled = key;
    key.clear();
    return !doubled;
  }

  static bool on_document_begin(Code&) { return true; }
  static bool on_document_end(Code&) { return true; }
  static bool on_array_begin(Code&) { return true; }
  static bool on_array_end(std::size_t, Code&) { return true; }
  static bool on_string_part(json::string_view, std::size_t, Code&) { return true; }
  static bool on_string(json::string_view, std::size_t, Code&) { return true; }
  static bool on_number_part(json::string_view, Code&) { return true; }
  static bool on_int64(std::int64_t, json::string_view, Code&) { return true; }
  static bool on_uint64(std::uint64_t, json::string_view, Code&) { return true; }
  static bool on_double(double, json::string_view, Code&) { return true; }
  static bool on_bool(bool, Code&) { return true; }
  static bool on_null(Code&) { return true; }
  static bool on_comment_part(json::string_view, Code&) { return true; }
  static bool on_comment(json::string_view, Code&) { return true; }

  std::vector<std::set<std::string>> objects;
  std::string key;
  std::optional<std::string> doubled;
};

}  // namespace

std::optional<std::string> find_doubled_key(std::string_view text) {
  json::basic_parser<Keys> parser{json::parse_options()};
  boost::system::error_code ignored;
  parser.write_some(false, text.data(), text.size(), ignored);
  return parser.handler().doubled;
}

}  // namespace calibrd::api
