// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose_numbers.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <string>

namespace calibrd {
namespace {

constexpr double kRotationTolerance = 1e-3;
constexpr double kLastRowTolerance = 1e-6;  // poses of other tools went through 32-bit floats
constexpr double kMaxDistance_m = 100;      // beyond any cell: then they are millimetres

const char* text(PoseNumbersError code) {
  switch (code) {
    case PoseNumbersError::wrong_count:
      return "a pose has 7 numbers (x, y, z, qx, qy, qz, qw), 12 (3x4) or 16 (4x4 matrix, row-major)";
    case PoseNumbersError::not_finite:
      return "a pose holds finite numbers only";
    case PoseNumbersError::not_a_rotation:
      return "the 3x3 part is not a rotation; give a right-handed matrix of unit columns, row-major";
    case PoseNumbersError::no_direction:
      return "the quaternion (last four numbers, order x y z w) is zero or huge";
    case PoseNumbersError::bad_last_row:
      return "the last row of the 4x4 matrix is not 0 0 0 1; give it row-major, metres";
    case PoseNumbersError::too_far:
      return "more than 100 m away; translations are in metres";
  }
  return "unknown pose error";
}

class Category final : public std::error_category {
 public:
  const char* name() const noexcept override { return "pose_numbers"; }
  std::string message(int code) const override { return text(static_cast<PoseNumbersError>(code)); }
};

Result<Pose> of_quaternion(std::span<const double> n) {
  const Eigen::Quaterniond q(n[6], n[3], n[4], n[5]);
  if (!(q.norm() > 1e-6 && q.norm() < 1e6)) return Error{PoseNumbersError::no_direction, {}};
  Pose pose = Pose::Identity();
  pose.linear() = q.normalized().toRotationMatrix();
  pose.translation() = Eigen::Vector3d(n[0], n[1], n[2]);
  return pose;
}

Result<Pose> of_matrix(std::span<const double> n) {
  Eigen::Matrix<double, 3, 4> rows;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) rows(r, c) = n[static_cast<std::size_t>(4 * r + c)];
  const Eigen::Matrix3d given = rows.leftCols<3>();
  if (!((given.transpose() * given - Eigen::Matrix3d::Identity()).norm() <= kRotationTolerance) ||
      given.determinant() < 0)
    return Error{PoseNumbersError::not_a_rotation, {}};
  // The nearest exact rotation: what was typed in has few digits, and the error would grow with each product.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(given, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Pose pose = Pose::Identity();
  pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  pose.translation() = rows.col(3);
  return pose;
}

}  // namespace

const std::error_category& pose_numbers_category() {
  static const Category category;
  return category;
}

std::error_code make_error_code(PoseNumbersError code) {
  return {static_cast<int>(code), pose_numbers_category()};
}

Result<Pose> pose_of_numbers(std::span<const double> numbers) {
  if (!std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); }))
    return Error{PoseNumbersError::not_finite, {}};
  if (numbers.size() != 7 && numbers.size() != 12 && numbers.size() != 16)
    return Error{PoseNumbersError::wrong_count, {}};
  if (numbers.size() == 16 &&
      !(Eigen::Map<const Eigen::RowVector4d>(&numbers[12]) - Eigen::RowVector4d(0, 0, 0, 1))
           .isZero(kLastRowTolerance))
    return Error{PoseNumbersError::bad_last_row, {}};
  auto pose = numbers.size() == 7 ? of_quaternion(numbers) : of_matrix(numbers);
  if (pose && pose->translation().cwiseAbs().maxCoeff() > kMaxDistance_m)
    return Error{PoseNumbersError::too_far, {}};
  return pose;
}

}  // namespace calibrd
