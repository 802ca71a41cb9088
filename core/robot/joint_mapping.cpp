// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/joint_mapping.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace calibrd {

Result<std::vector<double>> JointMapping::apply(std::span<const double> controller,
                                                double offset_factor) const {
  if (controller.size() < values_read_)
    return Error{JointMappingError::too_few_values,
                 std::to_string(controller.size()) + " values, " + std::to_string(values_read_) + " needed"};
  std::vector<double> joints;
  joints.reserve(rows_.size());
  for (const Row& row : rows_)
    joints.push_back(std::accumulate(
        row.terms.begin(), row.terms.end(), offset_factor * row.offset,
        [&](double sum, const Term& term) { return sum + term.factor * controller[term.axis]; }));
  return joints;
}

Result<std::vector<double>> JointMapping::positions(std::span<const double> controller) const {
  return apply(controller, 1);
}

Result<std::vector<double>> JointMapping::velocities(std::span<const double> controller) const {
  return apply(controller, 0);
}

Result<std::vector<double>> JointMapping::controller_values(std::span<const double> joints,
                                                            std::vector<double> controller) const {
  if (controller.size() < values_read_ || joints.size() != rows_.size())
    return Error{JointMappingError::too_few_values,
                 std::to_string(joints.size()) + " joints, " + std::to_string(controller.size()) + " values"};
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    const double factor = row.terms.front().factor;
    if (row.terms.size() != 1 || std::abs(factor) != 1)
      return Error{JointMappingError::not_invertible, "joint " + std::to_string(i + 1)};
    controller[row.terms.front().axis] = (joints[i] - row.offset) / factor;
  }
  return controller;
}

std::vector<int> JointMapping::axes() const {
  std::vector<int> axes;
  for (const Row& row : rows_) axes.push_back(static_cast<int>(row.terms.front().axis));
  return axes;
}

JointMappingConfig joints_in_wire_order(std::span<const std::string> joints) {
  JointMappingConfig config;
  for (const auto& joint : joints) {
    const auto index = static_cast<int>(config.joints.size());
    config.joints.push_back({.joint = joint, .axis = index, .coupling = {}});
  }
  return config;
}

Result<JointMappingConfig> yaskawa_7axis_wire(std::span<const std::string> model_joints) {
  if (model_joints.size() != 7)
    return Error{JointMappingError::wrong_joint_count,
                 "yaskawa_7axis_wire with " + std::to_string(model_joints.size()) + " movable joints"};
  JointMappingConfig config = joints_in_wire_order(model_joints);
  config.axis_names = {"S", "L", "E", "U", "R", "B", "T"};
  return config;
}

std::optional<Error> find_pendant_order(const JointMapping& mapping) {
  // Model joints run S L E U R B T; on the pendant E comes last.
  if (mapping.axes() != std::vector{0, 1, 6, 2, 3, 4, 5}) return std::nullopt;
  return Error{JointMappingError::pendant_order,
               "the third joint from the base is mapped to the seventh axis"};
}

}  // namespace calibrd
