// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/joint_mapping_error.hpp"

#include <string>

namespace calibrd {
namespace {

const char* text(JointMappingError code) {
  switch (code) {
    case JointMappingError::missing_joint:
      return "no controller axis is given for this joint of the robot model; add it to the joint mapping";
    case JointMappingError::unknown_joint:
      return "the robot model has no movable joint of this name; use one of its joint names";
    case JointMappingError::joint_twice:
      return "the joint is mapped twice; keep one of the two entries";
    case JointMappingError::unknown_axis:
      return "no controller axis has this name; use one of the axis names, or the axis' index from 0";
    case JointMappingError::axis_out_of_range:
      return "the controller sends no axis of this index; indices start at 0";
    case JointMappingError::axis_twice:
      return "two joints are driven by the same controller axis; correct one of them (an axis that acts on a "
             "second joint belongs in that joint's coupling)";
    case JointMappingError::bad_number:
      return "not usable; sign must be 1 or -1, scale greater than zero, offset and coupling factors finite";
    case JointMappingError::too_few_values:
      return "the controller sent fewer values than the joint mapping reads; check the robot group and the "
             "mapping";
    case JointMappingError::wrong_joint_count:
      return "this preset is for robots of 7 movable joints; map the joints one by one instead";
    case JointMappingError::pendant_order:
      return "this is the order of the teach pendant (S L U R B T E), but the wire carries S L E U R B T; "
             "list the joints from base to tool, the elbow axis E third";
    case JointMappingError::not_invertible:
      return "its controller axis is scaled or coupled, so the robot cannot be commanded; switch "
             "motion.enabled off";
  }
  return "unknown joint mapping error";
}

class JointMappingCategory final : public std::error_category {
 public:
  const char* name() const noexcept override { return "joint_mapping"; }
  std::string message(int code) const override { return text(static_cast<JointMappingError>(code)); }
};

}  // namespace

const std::error_category& joint_mapping_category() {
  static const JointMappingCategory category;
  return category;
}

std::error_code make_error_code(JointMappingError code) {
  return {static_cast<int>(code), joint_mapping_category()};
}

}  // namespace calibrd
