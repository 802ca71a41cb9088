// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <system_error>

namespace calibrd {

/// Why controller values cannot be mapped to the model's joints. Error::detail names the joint or axis.
enum class JointMappingError {
  missing_joint = 1,
  unknown_joint,
  joint_twice,
  unknown_axis,
  axis_out_of_range,
  axis_twice,
  bad_number,
  too_few_values,
  wrong_joint_count,
  pendant_order,
  not_invertible,
};

const std::error_category& joint_mapping_category();
std::error_code make_error_code(JointMappingError code);

}  // namespace calibrd

template <>
struct std::is_error_code_enum<calibrd::JointMappingError> : std::true_type {};
