// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/capture/pose_json.hpp"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/capture/file_bytes.hpp"
#include "core/capture/json_document.hpp"
#include "core/geometry/pose_numbers.hpp"

namespace calibrd {
namespace {

namespace json = boost::json;
constexpr std::uintmax_t kMaxPoseBytes = 16U << 20U;

Error bad_pose(const std::string& name, const std::string& why) {
  return fail(CaptureError::bad_pose_file, name + " (" + why + ")");
}

/// Appends the list's numbers; false when something else stands in it.
bool append_numbers(const json::value& list, std::vector<double>& numbers) {
  if (!list.is_array()) return false;
  for (const json::value& value : list.get_array()) {
    if (!value.is_number() || !std::isfinite(value.to_number<double>())) return false;
    numbers.push_back(value.to_number<double>());
  }
  return true;
}

/// 12 or 16 row-major numbers of a flat list or of 3 or 4 rows of 4; nothing when it is another shape.
std::optional<std::vector<double>> row_major(const json::value& matrix) {
  std::vector<double> numbers;
  if (append_numbers(matrix, numbers) && (numbers.size() == 12 || numbers.size() == 16)) return numbers;
  numbers.clear();
  if (!matrix.is_array() || matrix.get_array().size() < 3 || matrix.get_array().size() > 4)
    return std::nullopt;
  for (const json::value& row : matrix.get_array())
    if (!append_numbers(row, numbers) || numbers.size() % 4 != 0 || row.get_array().size() != 4)
      return std::nullopt;
  return numbers;
}

/// The pose of the numbers; an error is this module's, with its reason.
Result<Pose> pose_from(const std::vector<double>& numbers, const std::string& name) {
  auto pose = pose_of_numbers(numbers);
  if (!pose) return bad_pose(name, pose.error().message());
  return pose;
}

/// The numbers between commas; nothing when a field is not one finite number.
std::optional<std::vector<double>> comma_separated(std::string_view text) {
  constexpr std::string_view kBlank = " \t";
  std::vector<double> numbers;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    std::string_view field = text.substr(start, end - start);
    field.remove_prefix(std::min(field.find_first_not_of(kBlank), field.size()));
    field = field.substr(0, field.find_last_not_of(kBlank) + 1);
    if (field.starts_with('+')) field.remove_prefix(1);
    double value = 0;
    const auto [rest, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || rest != field.data() + field.size() || !std::isfinite(value))
      return std::nullopt;
    numbers.push_back(value);
    start = end + 1;
  }
  return numbers;
}

Result<Pose> pose_from_list(const std::string& text) {
  const auto numbers = comma_separated(text);
  if (!numbers) return bad_pose(text, "neither a file nor numbers between commas");
  if (numbers->size() != 7) return bad_pose(text, std::to_string(numbers->size()) + " numbers instead of 7");
  return pose_from(*numbers, text);
}

}  // namespace

Result<Pose> parse_pose_json(std::string_view json_text, const std::string& name) {
  const auto document = parse_json(json_text, name, CaptureError::bad_pose_file);
  if (!document) return document.error();
  const json::value* matrix =
      document->is_object() ? document->get_object().if_contains("T_base_sensor") : nullptr;
  if (matrix == nullptr) return bad_pose(name, "it holds no T_base_sensor");
  const auto numbers = row_major(*matrix);
  if (!numbers) return bad_pose(name, "T_base_sensor is not 3 or 4 rows of 4 numbers");
  return pose_from(*numbers, name);
}

Result<Pose> read_pose(const std::string& file_or_text) {
  std::error_code ignored;
  if (!std::filesystem::exists(file_or_text, ignored)) return pose_from_list(file_or_text);
  const auto text = read_bytes(file_or_text, kMaxPoseBytes);
  if (!text) return text.error();
  return parse_pose_json(*text, file_or_text);
}

}  // namespace calibrd
