// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/json/strict_object.hpp"

#include <algorithm>
#include <boost/json/array.hpp>
#include <boost/json/parser.hpp>
#include <boost/json/serialize.hpp>
#include <cmath>

#include "api/json/doubled_key.hpp"
#include "api/json/json_text.hpp"
#include "api/problem/api_error.hpp"
#include "core/base/text.hpp"
#include "core/robot/nearest_name.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

constexpr std::size_t kShownBytes = 60;
/// The deepest body there is holds a matrix in an object in the object: anything much deeper is an attack on
/// whoever walks through it.
constexpr std::size_t kMostNested = 16;

json::parse_options parse_options() {
  json::parse_options options;
  options.max_depth = kMostNested;
  return options;
}

/// The value under a key; nothing where it is absent or null.
const json::value* find(const json::object& object, std::string_view key) {
  const auto* value = object.if_contains(key);
  return value && !value->is_null() ? value : nullptr;
}

Error wrong(std::string_view key, const json::value& value, const std::string& wanted) {
  auto shown = json::serialize(value);
  if (value.is_double()) {  // 5.5, not 5.5E0
    shown = json_text(value);
    shown.pop_back();  // the end of its line
  }
  shown = shortened(shown, kShownBytes, "…");
  return fail(ApiError::bad_value, std::string(key) + ": " + shown + " is not " + wanted);
}

std::string plain(double number) {
  auto text = std::to_string(number);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

/// Where in the text parsing stopped, for people.
std::string place(std::string_view text, std::size_t byte) {
  const auto before = text.substr(0, byte);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const auto line_start = before.rfind('\n');
  const auto column = line_start == std::string_view::npos ? byte + 1 : byte - line_start;
  return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

bool is_json(std::string_view content_type) {
  std::string type(content_type.substr(0, content_type.find(';')));
  std::transform(type.begin(), type.end(), type.begin(), [](unsigned char c) { return std::tolower(c); });
  while (!type.empty() && type.back() == ' ') type.pop_back();
  return type == "application/json";
}

/// A header may hold any byte, an answer in JSON may not.
std::string in_ascii(std::string_view text) {
  std::string ascii(text);
  std::replace_if(
      ascii.begin(), ascii.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return ascii;
}

}  // namespace

Result<json::object> read_body(std::string_view body, std::string_view content_type,
                               std::initializer_list<std::string> known) {
  if (body.empty()) return json::object{};
  if (!is_json(content_type)) return fail(ApiError::wrong_content_type, in_ascii(content_type));
  json::parser parser({}, parse_options());
  boost::system::error_code failure;
  const auto used = parser.write_some(body.data(), body.size(), failure);
  const auto rest = body.substr(used).find_first_not_of(" \t\r\n");
  if (failure || rest != std::string_view::npos)
    return fail(ApiError::bad_json,
                place(body, used) + ": " + (failure ? failure.message() : "text after the end"));
  if (const auto doubled = find_doubled_key(body))
    return fail(ApiError::bad_value, *doubled + ": the key stands twice in one object; which one is meant?");
  const auto value = parser.release();
  const auto* object = value.if_object();
  if (!object) return fail(ApiError::bad_json, "an object { … } is wanted");
  const std::vector<std::string> names(known);
  for (const auto& member : *object)
    if (std::find(names.begin(), names.end(), member.key()) == names.end())
      return fail(ApiError::unknown_key,
                  std::string(member.key()) + " (" + name_hint(std::string(member.key()), names) + ")");
  return *object;
}

Result<bool> read_bool(const json::object& object, std::string_view key, bool otherwise) {
  const auto* value = find(object, key);
  if (!value) return otherwise;
  if (!value->is_bool()) return wrong(key, *value, "true or false");
  return value->get_bool();
}

Result<std::optional<int>> read_int(const json::object& object, std::string_view key, int min, int max) {
  const auto* value = find(object, key);
  if (!value) return std::optional<int>();
  const double number =
      value->is_number() ? value->to_number<double>() : min - 1.0;  // 5.0 is a whole number, too
  if (!(number >= min && number <= max) || number != std::floor(number))
    return wrong(key, *value, "a whole number from " + std::to_string(min) + " to " + std::to_string(max));
  return std::optional<int>(static_cast<int>(number));
}

Result<std::optional<double>> read_number(const json::object& object, std::string_view key, double min,
                                          double max) {
  const auto* value = find(object, key);
  if (!value) return std::optional<double>();
  const double number = value->is_number() ? value->to_number<double>() : min - 1;
  if (!(number >= min && number <= max))
    return wrong(key, *value, "a number from " + plain(min) + " to " + plain(max));
  return std::optional<double>(number);
}

Result<std::optional<std::string>> read_text(const json::object& object, std::string_view key,
                                             std::size_t max_length) {
  const auto* value = find(object, key);
  if (!value) return std::optional<std::string>();
  if (!value->is_string() || value->get_string().size() > max_length)
    return wrong(key, *value, "text of at most " + std::to_string(max_length) + " bytes");
  return std::optional<std::string>(std::string(value->get_string()));
}

std::optional<std::vector<double>> flat_numbers(const json::value& value) {
  if (!value.is_array()) return std::nullopt;
  std::vector<double> numbers;
  for (const auto& element : value.get_array()) {
    if (element.is_number()) {
      numbers.push_back(element.to_number<double>());
    } else if (const auto inner = flat_numbers(element)) {
      numbers.insert(numbers.end(), inner->begin(), inner->end());
    } else {
      return std::nullopt;
    }
  }
  return numbers;
}

std::size_t count_or_zero(const json::object& object, std::string_view key) {
  constexpr double kLargest = 1e9;  // beyond any count of ours; a cast of what does not fit is undefined
  const double number = number_or(object, key, 0);
  return number >= 0 && number <= kLargest ? static_cast<std::size_t>(number) : 0;
}

double number_or(const json::object& object, std::string_view key, double otherwise) {
  const auto* value = find(object, key);
  return value && value->is_number() ? value->to_number<double>() : otherwise;
}

std::string text_or(const json::object& object, std::string_view key, std::string otherwise) {
  const auto* value = find(object, key);
  return value && value->is_string() ? std::string(value->get_string()) : std::move(otherwise);
}

}  // namespace calibrd::api
