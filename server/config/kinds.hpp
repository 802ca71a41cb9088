// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "core/geometry/pose.hpp"
#include "server/config/config.hpp"
#include "server/config/raw_value.hpp"

namespace calibrd {

/// A type of setting: how it is called in the documentation, read from a raw value and written as TOML.
/// read() fails with ConfigError::bad_value, the detail saying what came and what is wanted.
/// write() gives an empty string for a value that is not set.
template <class T>
struct Kind {
  std::string name;
  std::function<Result<T>(const RawValue&)> read;
  std::function<std::string(const T&)> write;
};

Kind<int> integer(int min, int max);
Kind<int> one_of_numbers(std::vector<int> choices);
Kind<bool> flag();
Kind<double> real(double min, double max);
/// A real greater than zero; zero stands for "not set".
Kind<double> positive_real();
Kind<std::string> text();
Kind<std::string> one_of(std::vector<std::string> choices);
/// "250ms", "60s", "10min", "1h".
Kind<Duration> duration(Duration min, Duration max);
/// Relative paths are made absolute: from the folder of the file that holds them, or the working directory.
Kind<std::filesystem::path> path();
Kind<std::vector<std::filesystem::path>> paths();
/// ["one", "two"]
Kind<std::vector<std::string>> texts();
Kind<std::array<double, 5>> five_reals();
/// [x, y, z]
Kind<std::array<double, 3>> three_reals();
/// [[lower, upper], …]
Kind<std::vector<std::array<double, 2>>> ranges();
/// [x, y, z, qx, qy, qz, qw], or a 4x4 or 3x4 matrix, row-major, nested or flat.
Kind<std::optional<Pose>> optional_pose();

/// The duration of "250ms" and the like. Error: ConfigError::bad_value.
Result<Duration> parse_duration(const std::string& text);
std::string write_duration(Duration duration);

}  // namespace calibrd
