// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/kinds.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/geometry/pose_numbers.hpp"
#include "core/robot/nearest_name.hpp"
#include "server/config/config_error.hpp"
#include "server/config/quoted.hpp"

namespace calibrd {
namespace {

Error bad(std::string detail) { return Error{ConfigError::bad_value, std::move(detail)}; }

std::string number(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

/// The value as it would be written, for messages.
std::string shown(const RawValue& value) {
  if (value.text) return *value.text;
  struct Shower {
    std::string operator()(const std::string& s) const { return quoted(s); }
    std::string operator()(bool b) const { return b ? "true" : "false"; }
    std::string operator()(std::int64_t i) const { return std::to_string(i); }
    std::string operator()(double d) const { return number(d); }
    std::string operator()(const std::vector<RawValue>& a) const {
      return "a list of " + std::to_string(a.size());
    }
  };
  return std::visit(Shower{}, value.data);
}

std::optional<double> as_number(const RawValue& value) {
  std::optional<double> result;
  if (const auto* i = std::get_if<std::int64_t>(&value.data)) result = static_cast<double>(*i);
  if (const auto* d = std::get_if<double>(&value.data)) result = *d;
  return result && std::isfinite(*result) ? result : std::nullopt;
}

std::optional<std::string> as_string(const RawValue& value) {
  if (value.text && !std::holds_alternative<std::string>(value.data)) return value.text;
  if (const auto* s = std::get_if<std::string>(&value.data)) return *s;
  return std::nullopt;
}

/// Every number in a list, nested lists included; nothing when something in it is no number.
std::optional<std::vector<double>> as_numbers(const RawValue& value) {
  const auto* list = std::get_if<std::vector<RawValue>>(&value.data);
  if (!list) return std::nullopt;
  std::vector<double> numbers;
  for (const auto& element : *list) {
    if (const auto single = as_number(element)) {
      numbers.push_back(*single);
    } else if (const auto inner = as_numbers(element)) {
      numbers.insert(numbers.end(), inner->begin(), inner->end());
    } else {
      return std::nullopt;
    }
  }
  return numbers;
}

std::string number_list(const double* first, std::size_t count) {
  std::string list = "[";
  for (std::size_t i = 0; i < count; ++i) list += (i == 0 ? "" : ", ") + number(first[i]);
  return list + "]";
}

std::filesystem::path resolved(const std::string& written, const RawValue& value) {
  return written.empty() ? std::filesystem::path() : (value.folder / written).lexically_normal();
}

}  // namespace

Kind<int> integer(int min, int max) {
  const std::string name = "integer, " + std::to_string(min) + " to " + std::to_string(max);
  return {name,
          [=](const RawValue& value) -> Result<int> {
            const auto* i = std::get_if<std::int64_t>(&value.data);
            if (!i || *i < min || *i > max) return bad(shown(value) + " is not an " + name);
            return static_cast<int>(*i);
          },
          [](const int& value) { return std::to_string(value); }};
}

Kind<int> one_of_numbers(std::vector<int> choices) {
  std::string name;
  for (const int choice : choices) name.append(name.empty() ? "" : " | ").append(std::to_string(choice));
  return {name,
          [=](const RawValue& value) -> Result<int> {
            const auto* i = std::get_if<std::int64_t>(&value.data);
            if (!i || std::find(choices.begin(), choices.end(), *i) == choices.end())
              return bad(shown(value) + " is not one of " + name);
            return static_cast<int>(*i);
          },
          [](const int& value) { return std::to_string(value); }};
}

Kind<bool> flag() {
  return {"true | false",
          [](const RawValue& value) -> Result<bool> {
            const auto* b = std::get_if<bool>(&value.data);
            if (!b) return bad(shown(value) + " is neither true nor false");
            return *b;
          },
          [](const bool& value) { return std::string(value ? "true" : "false"); }};
}

Kind<double> real(double min, double max) {
  const std::string name = "number, " + number(min) + " to " + number(max);
  return {name,
          [=](const RawValue& value) -> Result<double> {
            const auto x = as_number(value);
            if (!x || *x < min || *x > max) return bad(shown(value) + " is not a " + name);
            return *x;
          },
          [](const double& value) { return number(value); }};
}

Kind<double> positive_real() {
  return {"number > 0",
          [](const RawValue& value) -> Result<double> {
            const auto x = as_number(value);
            if (!x || *x <= 0) return bad(shown(value) + " is not a number greater than 0");
            return *x;
          },
          [](const double& value) { return value > 0 ? number(value) : std::string(); }};
}

Kind<std::string> text() {
  return {"text",
          [](const RawValue& value) -> Result<std::string> {
            const auto s = as_string(value);
            if (!s) return bad(shown(value) + " is not text; put it in quotes");
            return *s;
          },
          [](const std::string& value) { return value.empty() ? std::string() : quoted(value); }};
}

Kind<std::string> one_of(std::vector<std::string> choices) {
  std::string name;
  for (const auto& choice : choices) name += (name.empty() ? "" : " | ") + quoted(choice);
  return {name,
          [=](const RawValue& value) -> Result<std::string> {
            const auto s = as_string(value);
            if (s && std::find(choices.begin(), choices.end(), *s) != choices.end()) return *s;
            return bad(shown(value) + " is not one of " + name +
                       (s ? "; " + name_hint(*s, choices) : std::string()));
          },
          [](const std::string& value) { return quoted(value); }};
}

Kind<Duration> duration(Duration min, Duration max) {
  const std::string name = "duration, " + write_duration(min) + " to " + write_duration(max);
  return {name,
          [=](const RawValue& value) -> Result<Duration> {
            const auto s = as_string(value);
            if (!s)
              return bad(shown(value) + " is not a duration; give it a unit: \"250ms\", \"60s\", \"10min\"");
            auto parsed = parse_duration(*s);
            if (parsed && (*parsed < min || *parsed > max)) return bad(shown(value) + " is not a " + name);
            return parsed;
          },
          [](const Duration& value) { return quoted(write_duration(value)); }};
}

Kind<std::filesystem::path> path() {
  return {"path",
          [](const RawValue& value) -> Result<std::filesystem::path> {
            const auto s = as_string(value);
            if (!s) return bad(shown(value) + " is not a path; put it in quotes");
            return resolved(*s, value);
          },
          [](const std::filesystem::path& value) {
            return value.empty() ? std::string() : quoted(value.string());
          }};
}

Kind<std::vector<std::filesystem::path>> paths() {
  return {"list of paths",
          [](const RawValue& value) -> Result<std::vector<std::filesystem::path>> {
            const auto* list = std::get_if<std::vector<RawValue>>(&value.data);
            if (!list) return bad(shown(value) + " is not a list of paths; write [\"one\", \"two\"]");
            std::vector<std::filesystem::path> all;
            for (const auto& element : *list) {
              const auto s = as_string(element);
              if (!s) return bad(shown(element) + " in the list is not a path; put it in quotes");
              all.push_back(resolved(*s, value));
            }
            return all;
          },
          [](const std::vector<std::filesystem::path>& value) {
            std::string list;
            for (const auto& one : value) list += (list.empty() ? "" : ", ") + quoted(one.string());
            return "[" + list + "]";
          }};
}

namespace {

template <std::size_t N>
Kind<std::array<double, N>> some_reals(std::string name) {
  return {name,
          [name](const RawValue& value) -> Result<std::array<double, N>> {
            const auto numbers = as_numbers(value);
            if (!numbers || numbers->size() != N) return bad(shown(value) + " is not a " + name);
            std::array<double, N> all{};
            std::copy(numbers->begin(), numbers->end(), all.begin());
            return all;
          },
          [](const std::array<double, N>& value) { return number_list(value.data(), value.size()); }};
}

}  // namespace

Kind<std::array<double, 5>> five_reals() { return some_reals<5>("list of 5 numbers"); }

Kind<std::array<double, 3>> three_reals() { return some_reals<3>("list of 3 numbers"); }

Kind<std::vector<std::array<double, 2>>> ranges() {
  return {"list of [lower, upper]",
          [](const RawValue& value) -> Result<std::vector<std::array<double, 2>>> {
            const auto numbers = as_numbers(value);
            if (!numbers || numbers->size() % 2 != 0)
              return bad(shown(value) + " is not a list of [lower, upper]");
            std::vector<std::array<double, 2>> all;
            for (std::size_t i = 0; i < numbers->size(); i += 2)
              all.push_back({(*numbers)[i], (*numbers)[i + 1]});
            return all;
          },
          [](const std::vector<std::array<double, 2>>& value) {
            std::string list;
            for (const auto& range : value)
              list.append(list.empty() ? "" : ", ").append(number_list(range.data(), range.size()));
            return std::string("[").append(list).append("]");
          }};
}

Kind<std::optional<Pose>> optional_pose() {
  return {"[x, y, z, qx, qy, qz, qw] or 4x4 matrix",
          [](const RawValue& value) -> Result<std::optional<Pose>> {
            const auto numbers = as_numbers(value);
            if (!numbers)
              return bad(shown(value) + " is not a pose: a list of 7, 12 or 16 numbers is wanted");
            auto pose = pose_of_numbers(*numbers);
            if (!pose) return bad(pose.error().message());
            return std::optional<Pose>(*pose);
          },
          [](const std::optional<Pose>& value) {
            if (!value) return std::string();
            const Eigen::Quaterniond q(value->linear());
            const auto& t = value->translation();
            const std::array<double, 7> all{t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
            return number_list(all.data(), all.size());
          }};
}

Result<Duration> parse_duration(const std::string& text) {
  double count = 0;
  const auto [unit_begin, failure] = std::from_chars(text.data(), text.data() + text.size(), count);
  const std::string unit(unit_begin, text.data() + text.size());
  double unit_ms = 0;
  if (unit == "ms") unit_ms = 1;
  if (unit == "s") unit_ms = 1000;
  if (unit == "min") unit_ms = 60'000;
  if (unit == "h") unit_ms = 3'600'000;
  if (failure != std::errc() || unit_ms == 0 || !(count >= 0) || count * unit_ms > 1e12)
    return bad("\"" + text + "\" is not a duration; write a number and ms, s, min or h, for example \"60s\"");
  return Duration(static_cast<Duration::rep>(std::llround(count * unit_ms)));
}

std::string write_duration(Duration duration) {
  const auto ms = duration.count();
  if (ms != 0 && ms % 3'600'000 == 0) return std::to_string(ms / 3'600'000) + "h";
  if (ms != 0 && ms % 60'000 == 0) return std::to_string(ms / 60'000) + "min";
  if (ms % 1000 == 0) return std::to_string(ms / 1000) + "s";
  return std::to_string(ms) + "ms";
}

}  // namespace calibrd
