// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/capture/json_document.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/text.hpp"

namespace calibrd {
namespace {

namespace json = boost::json;

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::string line_and_column(std::string_view text, std::size_t place) {
  const std::string_view before = text.substr(0, place);
  const auto line = 1 + std::ranges::count(before, '\n');
  const std::size_t start = before.find_last_of('\n') + 1;  // npos + 1 = 0: the first line
  return "line " + std::to_string(line) + ", column " + std::to_string(place - start + 1);
}

/// The value as written, shortened: an error message is one line.
std::string shown(const json::value& value) {
  constexpr std::size_t kLongest = 40;
  return shortened(json::serialize(value), kLongest, "...");
}

Error not_a(const char* expected, const std::string& name, const json::value& value) {
  return fail(CaptureError::bad_value, name + " (" + shown(value) + "; expected " + expected + ")");
}

bool is_finite_number(const json::value& value) {
  return value.is_number() && std::isfinite(value.to_number<double>());
}

}  // namespace

Result<json::value> parse_json(std::string_view text, const std::string& name, CaptureError code) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  json::stream_parser parser;
  boost::system::error_code error;
  const std::size_t place = parser.write(text.data(), text.size(), error);
  if (!error) parser.finish(error);
  if (error) return fail(code, name + " (" + line_and_column(text, place) + ": " + error.message() + ")");
  return parser.release();
}

std::string JsonNode::name(std::string_view key) const {
  return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

Result<const json::value*> JsonNode::find(std::string_view key) const {
  if (const json::value* value = object_.if_contains(key)) return value;
  return fail(CaptureError::missing_key, name(key));
}

Result<double> JsonNode::number(std::string_view key) const {
  const auto value = find(key);
  if (!value) return value.error();
  if (!is_finite_number(**value)) return not_a("a finite number", name(key), **value);
  return (*value)->to_number<double>();
}

Result<std::string> JsonNode::text(std::string_view key) const {
  const auto value = find(key);
  if (!value) return value.error();
  if (!(*value)->is_string()) return not_a("a text", name(key), **value);
  return std::string((*value)->get_string());
}

Result<std::string> JsonNode::text_or(std::string_view key, std::string fallback) const {
  return has(key) ? text(key) : std::move(fallback);
}

Result<const json::array*> JsonNode::array(std::string_view key) const {
  const auto value = find(key);
  if (!value) return value.error();
  if (!(*value)->is_array()) return not_a("a list", name(key), **value);
  return &(*value)->get_array();
}

Result<std::vector<double>> JsonNode::numbers(std::string_view key) const {
  const auto list = array(key);
  if (!list) return list.error();
  std::vector<double> values;
  for (const json::value& value : **list) {
    if (!is_finite_number(value)) return not_a("finite numbers", name(key), value);
    values.push_back(value.to_number<double>());
  }
  return values;
}

Result<std::vector<std::string>> JsonNode::texts(std::string_view key) const {
  const auto list = array(key);
  if (!list) return list.error();
  std::vector<std::string> values;
  for (const json::value& value : **list) {
    if (!value.is_string()) return not_a("texts", name(key), value);
    values.emplace_back(value.get_string());
  }
  return values;
}

Result<JsonNode> JsonNode::object(std::string_view key) const {
  const auto value = find(key);
  if (!value) return value.error();
  if (!(*value)->is_object()) return not_a("an object", name(key), **value);
  return JsonNode((*value)->get_object(), name(key));
}

Result<std::vector<JsonNode>> JsonNode::objects(std::string_view key) const {
  const auto list = array(key);
  if (!list) return list.error();
  std::vector<JsonNode> nodes;
  for (std::size_t i = 0; i < (*list)->size(); ++i) {
    const std::string path = name(key) + "[" + std::to_string(i) + "]";
    if (!(**list)[i].is_object()) return not_a("an object", path, (**list)[i]);
    nodes.emplace_back((**list)[i].get_object(), path);
  }
  return nodes;
}

}  // namespace calibrd
