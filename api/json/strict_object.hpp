// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/json/object.hpp>
#include <boost/json/value.hpp>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"

namespace calibrd::api {

/// The object a request body holds; an empty body stands for {}.
/// Errors: ApiError::bad_json, wrong_content_type, unknown_key (with the nearest of `known`).
Result<boost::json::object> read_body(std::string_view body, std::string_view content_type,
                                      std::initializer_list<std::string> known);

/// The value of a key, or `otherwise` where the key is absent or null. Errors: ApiError::bad_value, naming
/// the key.
Result<bool> read_bool(const boost::json::object& object, std::string_view key, bool otherwise);
Result<std::optional<int>> read_int(const boost::json::object& object, std::string_view key, int min,
                                    int max);
Result<std::optional<double>> read_number(const boost::json::object& object, std::string_view key, double min,
                                          double max);
Result<std::optional<std::string>> read_text(const boost::json::object& object, std::string_view key,
                                             std::size_t max_length);

/// The numbers of an array, nested arrays included; nothing when something in it is no number.
std::optional<std::vector<double>> flat_numbers(const boost::json::value& value);

/// For objects this program wrote itself: the value where it is there and of its type.
double number_or(const boost::json::object& object, std::string_view key, double otherwise);
/// 0 as well for a number that counts nothing: negative, or beyond a thousand million.
std::size_t count_or_zero(const boost::json::object& object, std::string_view key);
std::string text_or(const boost::json::object& object, std::string_view key, std::string otherwise);

}  // namespace calibrd::api
