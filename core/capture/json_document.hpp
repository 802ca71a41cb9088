// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
// Shows Boost.JSON: included by .cpp files of this folder alone.
#include <boost/json.hpp>
#include <string>
#include <string_view>

#include "core/base/result.hpp"
#include "core/capture/capture_error.hpp"

namespace calibrd {

/// JSON text as a value, nested at most 32 deep; a byte order mark in front is skipped. An error is `code`,
/// its detail `name` with line, column and what is wrong there.
Result<boost::json::value> parse_json(std::string_view text, const std::string& name, CaptureError code);

/// A JSON object and the way to it, so that every error names the key at fault.
/// Errors: CaptureError::missing_key, bad_value.
class JsonNode {
 public:
  JsonNode(const boost::json::object& object, std::string path) : object_(object), path_(std::move(path)) {}

  bool has(std::string_view key) const { return object_.contains(key); }
  std::string name(std::string_view key) const;

  Result<double> number(std::string_view key) const;  ///< finite
  Result<std::string> text(std::string_view key) const;
  Result<std::string> text_or(std::string_view key, std::string fallback) const;
  Result<std::vector<double>> numbers(std::string_view key) const;  ///< all finite
  Result<std::vector<std::string>> texts(std::string_view key) const;
  Result<JsonNode> object(std::string_view key) const;
  Result<std::vector<JsonNode>> objects(std::string_view key) const;

 private:
  Result<const boost::json::value*> find(std::string_view key) const;
  Result<const boost::json::array*> array(std::string_view key) const;

  const boost::json::object& object_;
  std::string path_;
};

}  // namespace calibrd
