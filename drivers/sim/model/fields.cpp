// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/model/fields.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace calibrd::sim {

namespace json = boost::json;

namespace {

const json::value& empty_object() {
  static const json::value empty = json::object{};
  return empty;
}

/// All numbers of nested arrays, in order; nothing when there is something else among them.
bool collect_numbers(const json::value& value, std::vector<double>& out) {
  if (value.is_number()) {
    out.push_back(value.to_number<double>());
    return std::isfinite(out.back());
  }
  if (!value.is_array()) return false;
  return std::all_of(value.get_array().begin(), value.get_array().end(),
                     [&](const json::value& element) { return collect_numbers(element, out); });
}

}  // namespace

Fields::Fields(const json::value& value, std::string where, SimError code)
    : where_(std::move(where)), code_(code) {
  object_ = value.if_object();
  if (object_ == nullptr) {
    object_ = empty_object().if_object();
    error_ = sim_error(code_, where_ + ": expected a JSON object");
  }
}

std::string Fields::path(std::string_view key) const {
  return where_.empty() ? std::string(key) : where_ + "." + std::string(key);
}

void Fields::fail(std::string_view key, std::string_view expected) {
  if (!error_) error_ = sim_error(code_, path(key) + ": expected " + std::string(expected));
}

bool Fields::has(std::string_view key) const { return object_->contains(key); }

const json::value* Fields::child(std::string_view key) {
  known_.emplace_back(key);
  return object_->if_contains(key);
}

Fields Fields::object(std::string_view key) {
  const json::value* value = child(key);
  return {value != nullptr ? *value : empty_object(), path(key), code_};
}

void Fields::number(std::string_view key, double& value, double low, double high) {
  const json::value* found = child(key);
  if (found == nullptr) return;
  const double number = found->is_number() ? found->to_number<double>() : std::nan("");
  if (!std::isfinite(number) || number < low || number > high) {
    std::string expected = "a number";
    if (low > -kAny || high < kAny)
      expected += " from " + std::to_string(low) + " to " + std::to_string(high);
    return fail(key, expected);
  }
  value = number;
}

void Fields::integer(std::string_view key, std::int32_t& value, std::int32_t low, std::int32_t high) {
  double number = value;
  this->number(key, number, low, high);
  if (number != std::floor(number)) return fail(key, "a whole number");
  value = static_cast<std::int32_t>(number);
}

void Fields::whole(std::string_view key, std::uint64_t& value) {
  const json::value* found = child(key);
  if (found == nullptr) return;
  boost::system::error_code wrong;
  const auto number = found->is_number() ? found->to_number<std::uint64_t>(wrong) : 0;
  if (!found->is_number() || wrong) return fail(key, "a whole number of 0 or more");
  value = number;
}

void Fields::flag(std::string_view key, std::int32_t& value) {
  const json::value* found = child(key);
  if (found == nullptr) return;
  if (!found->is_bool()) return fail(key, "true or false");
  value = found->get_bool() ? 1 : 0;
}

void Fields::text(std::string_view key, std::string& value) {
  const json::value* found = child(key);
  if (found == nullptr) return;
  if (!found->is_string()) return fail(key, "a text");
  value = std::string(found->get_string());
}

void Fields::degrees(std::string_view key, double& value_rad) {
  double degrees = value_rad * 180 / std::numbers::pi;
  number(key, degrees);
  if (has(key)) value_rad = degrees * std::numbers::pi / 180;
}

void Fields::numbers(std::string_view key, std::vector<double>& values, std::size_t size) {
  const json::value* found = child(key);
  if (found == nullptr) return;
  std::vector<double> read;
  if (!found->is_array() || !collect_numbers(*found, read) || (size != 0 && read.size() != size))
    return fail(key, size != 0 ? std::to_string(size) + " numbers" : "a list of numbers");
  values = std::move(read);
}

void Fields::vector(std::string_view key, Eigen::Vector3d& value) {
  std::vector<double> values(value.data(), value.data() + 3);
  numbers(key, values, 3);
  value = Eigen::Vector3d(values.data());
}

void Fields::matrix(std::string_view key, Eigen::Isometry3d& pose) {
  if (!has(key)) return;
  constexpr double kNotARotation = 1e-3;
  std::vector<double> values;
  numbers(key, values, 0);
  if (values.size() != 12 && values.size() != 16) return fail(key, "4x4, 3x4 or 12 numbers, row by row");
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> rows(values.data());
  const Eigen::Matrix3d rotation = rows.leftCols<3>();
  if ((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() > kNotARotation ||
      rotation.determinant() < 0)
    return fail(key, "a rotation in the first three columns");
  pose.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  pose.translation() = rows.col(3);
}

void Fields::choice(std::string_view key, std::initializer_list<std::string_view> names, int& value) {
  const json::value* found = child(key);
  if (found == nullptr) return;
  std::string expected = "one of";
  int index = 0;
  for (std::string_view name : names) {
    if (found->is_string() && std::string_view(found->get_string()) == name) {
      value = index;
      return;
    }
    expected += " \"" + std::string(name) + "\"";
    ++index;
  }
  fail(key, expected);
}

Status Fields::finish() {
  for (const auto& [key, value] : *object_) {
    if (error_) break;
    if (std::find(known_.begin(), known_.end(), std::string_view(key)) != known_.end()) continue;
    std::string known = "no such key; known are";
    for (const auto& name : known_) known += " " + name;
    error_ = sim_error(code_, path(key) + ": " + known);
  }
  if (error_) return *error_;
  return Done{};
}

Result<json::value> parse_json(std::string_view text, std::string where, SimError code) {
  json::stream_parser parser;
  boost::system::error_code wrong;
  const std::size_t read = parser.write_some(text.data(), text.size(), wrong);
  if (!wrong && !parser.done()) parser.finish(wrong);
  const bool trailing = text.find_first_not_of(" \t\r\n", read) != std::string_view::npos;
  if (!wrong && !trailing) return parser.release();
  return sim_error(code, where + ": not JSON, at byte " + std::to_string(read) +
                             (wrong ? " (" + wrong.message() + ")" : " (more text after the end)"));
}

json::value to_json(const Eigen::Isometry3d& pose) {
  json::array rows;
  for (int r = 0; r < 4; ++r) {
    json::array row;
    for (int c = 0; c < 4; ++c) row.push_back(pose.matrix()(r, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace calibrd::sim
