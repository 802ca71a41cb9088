// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <boost/json.hpp>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/sim/world/sim_error.hpp"

namespace calibrd::sim {

/// Reads a JSON object key by key into defaults, and remembers the first thing wrong with it: a value of the
/// wrong kind or out of range, or (at finish) a key nobody asked for. A key that is absent leaves the default
/// alone.
class Fields {
 public:
  /// `where` is what messages call this object; `code` the error they carry.
  Fields(const boost::json::value& value, std::string where, SimError code);

  bool has(std::string_view key) const;
  void number(std::string_view key, double& value, double low = -kAny, double high = kAny);
  void integer(std::string_view key, std::int32_t& value, std::int32_t low, std::int32_t high);
  void whole(std::string_view key, std::uint64_t& value);
  void flag(std::string_view key, std::int32_t& value);  ///< true or false, kept as 1 or 0
  void text(std::string_view key, std::string& value);
  void degrees(std::string_view key, double& value_rad);
  /// Exactly `size` numbers where `size` is not 0.
  void numbers(std::string_view key, std::vector<double>& values, std::size_t size);
  void vector(std::string_view key, Eigen::Vector3d& value);
  void matrix(std::string_view key, Eigen::Isometry3d& pose);  ///< 4x4, 3x4 or 12 numbers, row by row
  /// One of `names`; `value` becomes its index.
  void choice(std::string_view key, std::initializer_list<std::string_view> names, int& value);

  /// The value of a key that something else reads; null when absent.
  const boost::json::value* child(std::string_view key);
  Fields object(std::string_view key);  ///< empty object when absent
  std::string path(std::string_view key) const;

  void fail(std::string_view key, std::string_view expected);
  /// The first error, or that of the first unknown key.
  Status finish();

 private:
  static constexpr double kAny = std::numeric_limits<double>::infinity();
  const boost::json::object* object_ = nullptr;
  std::string where_;
  SimError code_;
  std::vector<std::string> known_;
  std::optional<Error> error_;
};

/// Parses text as JSON. Errors: `code`, with the place of the mistake.
Result<boost::json::value> parse_json(std::string_view text, std::string where, SimError code);

/// Row by row, 4x4.
boost::json::value to_json(const Eigen::Isometry3d& pose);

}  // namespace calibrd::sim
