// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/header_numbers.hpp"

#include <array>
#include <charconv>

namespace calibrd::api {

std::string number_text(double value) {
  std::array<char, 32> buffer{};
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

std::string numbers_text(std::span<const double> values) {
  std::string text;
  for (const double value : values) text.append(text.empty() ? "" : " ").append(number_text(value));
  return text;
}

std::string pose_text(const Pose& pose) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = pose.matrix();
  return numbers_text({rows.data(), 16});
}

std::int64_t stamp_ns(Clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

}  // namespace calibrd::api
