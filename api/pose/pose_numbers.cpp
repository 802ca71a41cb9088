// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/pose/pose_numbers.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <string>

namespace calibrd::api {
namespace {

constexpr double kTolerance = 1e-3;

const char* text(PoseNumbersError code) {
  switch (code) {
    case PoseNumbersError::wrong_count:
      return "a pose has 7 numbers (x, y, z, qx, qy, qz, qw), 12 (3x4) or 16 (4x4 matrix, row-major)";
    case PoseNumbersError::not_finite:
      return "a pose holds finite numbers only";
    case PoseNumbersError::not_a_rotation:
      return "the 3x3 part is not a rotation; give a right-handed matrix of unit columns, row-major";
    case PoseNumbersError::not_a_unit_quaternion:
      return "the quaternion (last four numbers, order x y z w) does not have length 1";
    case PoseNumbersError::bad_last_row:
      return "the last row of the 4x4 matrix is not 0 0 0 1; give it row-major, metres";
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
  if (std::abs(q.norm() - 1) > kTolerance) return Error{PoseNumbersError::not_a_unit_quaternion, {}};
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
  if ((given.transpose() * given - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > kTolerance ||
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
  if (numbers.size() == 7) return of_quaternion(numbers);
  if (numbers.size() != 12 && numbers.size() != 16) return Error{PoseNumbersError::wrong_count, {}};
  if (numbers.size() == 16 &&
      (std::abs(numbers[12]) + std::abs(numbers[13]) + std::abs(numbers[14]) + std::abs(numbers[15] - 1) >
       1e-9))
    return Error{PoseNumbersError::bad_last_row, {}};
  return of_matrix(numbers);
}

}  // namespace calibrd::api
