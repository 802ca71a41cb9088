// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/capture/pose_json.hpp"

#include <Eigen/SVD>
#include <boost/json.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "core/capture/capture_error.hpp"

namespace calibrd {
namespace {

namespace json = boost::json;
constexpr double kRotationTolerance = 1e-3;

/// All numbers of a (nested) array, row-major; false when something else stands in it.
bool collect_numbers(const json::value& value, std::vector<double>& numbers) {
  if (value.is_number()) {
    numbers.push_back(value.to_number<double>());
    return std::isfinite(numbers.back());
  }
  if (!value.is_array()) return false;
  for (const json::value& item : value.get_array()) {
    if (!collect_numbers(item, numbers)) return false;
  }
  return true;
}

Result<Pose> pose_from_numbers(const std::vector<double>& m, const std::string& name) {
  const bool full = m.size() == 16;
  if (m.size() != 12 && !full)
    return fail(CaptureError::bad_pose_file,
                name + ": T_base_sensor holds " + std::to_string(m.size()) + " numbers");
  if (full && (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1))
    return fail(CaptureError::bad_pose_file, name + ": the last row of T_base_sensor is not 0 0 0 1");
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) R(row, column) = m[static_cast<std::size_t>(4 * row + column)];
    t[row] = m[static_cast<std::size_t>(4 * row + 3)];
  }
  if ((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() > kRotationTolerance || R.determinant() < 0)
    return fail(CaptureError::bad_pose_file, name + ": the rotation part of T_base_sensor is not a rotation");
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Pose pose = Pose::Identity();
  pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  pose.translation() = t;
  return pose;
}

Result<Pose> pose_from_list(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream stream(text);
  for (std::string field; std::getline(stream, field, ',');) {
    std::size_t used = 0;
    try {
      numbers.push_back(std::stod(field, &used));
    } catch (const std::exception&) {
      used = 0;
    }
    if (used == 0 || field.find_first_not_of(" \t", used) != std::string::npos ||
        !std::isfinite(numbers.back()))
      return fail(CaptureError::bad_pose_file, text);
  }
  if (numbers.size() != 7) return fail(CaptureError::bad_pose_file, text);
  const Eigen::Quaterniond q(numbers[6], numbers[3], numbers[4], numbers[5]);
  if (q.norm() < 1e-6) return fail(CaptureError::bad_pose_file, text + ": the quaternion is zero");
  Pose pose = Pose::Identity();
  pose.linear() = q.normalized().toRotationMatrix();
  pose.translation() << numbers[0], numbers[1], numbers[2];
  return pose;
}

}  // namespace

Result<Pose> parse_pose_json(std::string_view json_text, const std::string& name) {
  boost::system::error_code error;
  const json::value document = json::parse(json_text, error);
  if (error) return fail(CaptureError::bad_pose_file, name + " (" + error.message() + ")");
  const json::value* matrix =
      document.is_object() ? document.get_object().if_contains("T_base_sensor") : nullptr;
  std::vector<double> numbers;
  if (matrix == nullptr || !collect_numbers(*matrix, numbers)) return fail(CaptureError::bad_pose_file, name);
  return pose_from_numbers(numbers, name);
}

Result<Pose> read_pose(const std::string& file_or_text) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file_or_text, ignored)) return pose_from_list(file_or_text);
  std::ifstream file(file_or_text);
  std::ostringstream text;
  text << file.rdbuf();
  return parse_pose_json(text.str(), file_or_text);
}

}  // namespace calibrd
