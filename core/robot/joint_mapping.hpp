// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/base/result.hpp"
#include "core/robot/joint_mapping_error.hpp"

namespace calibrd {

/// A value the controller sends: its index on the wire, from 0, or its name in
/// JointMappingConfig::axis_names.
using ControllerAxis = std::variant<int, std::string>;

/// A controller axis that also moves a joint it does not belong to.
struct AxisCoupling {
  ControllerAxis axis;
  double factor = 0;
};

/// How one joint of the model follows the controller:
///   joint = sign · scale · (axis + Σ factor · coupled axis) + offset_rad
/// FANUC's J3, stated against the horizontal: {"joint_3", 2, .coupling = {{1, 1.0}}}.
struct JointMappingEntry {
  std::string joint;  ///< name in the robot model
  ControllerAxis axis;
  double sign = 1;        ///< 1 or -1
  double scale = 1;       ///< greater than zero; turns other units into rad or m
  double offset_rad = 0;  ///< m for a prismatic joint
  std::vector<AxisCoupling> coupling;
};

struct JointMappingConfig {
  std::vector<JointMappingEntry> joints;  ///< one for each movable joint of the model, in any order
  int axis_count = 10;                  ///< values the controller sends; simple_message: 10, the rest unused
  std::vector<std::string> axis_names;  ///< by index on the wire; empty: axes are given by index only
};

/// From what the controller sends to what the robot model takes. Immutable: safe to use from any thread.
class JointMapping {
 public:
  /// model_joints: RobotModel::position_names().
  /// Errors: JointMappingError, each naming joint or axis and, for a misspelt one, the nearest name.
  static Result<JointMapping> make(const JointMappingConfig& config,
                                   std::span<const std::string> model_joints);

  /// Model positions (order of model_joints, rad or m) from the controller's values.
  /// Error: JointMappingError::too_few_values.
  Result<std::vector<double>> positions(std::span<const double> controller) const;

  /// The same for velocities: offsets do not count.
  Result<std::vector<double>> velocities(std::span<const double> controller) const;

  /// The way back, for controllers whose axes turn as the model's joints do, but for sign and offset: what
  /// the controller is at when the model is at `joints`. Values that belong to no joint stay as in
  /// `controller`. Errors: JointMappingError::too_few_values, not_invertible (an axis is scaled or coupled).
  Result<std::vector<double>> controller_values(std::span<const double> joints,
                                                std::vector<double> controller) const;

  /// Number of joints of the model.
  std::size_t size() const { return rows_.size(); }

  /// The controller axis each joint belongs to, as index on the wire.
  std::vector<int> axes() const;

 private:
  struct Term {
    std::size_t axis;
    double factor;
  };
  struct Row {
    std::vector<Term> terms;  // the joint's own axis first
    double offset = 0;
  };

  friend class JointMappingBuilder;
  Result<std::vector<double>> apply(std::span<const double> controller, double offset_factor) const;

  std::vector<Row> rows_;
  std::size_t values_read_ = 0;
};

/// The joints in the order in which the controller sends them, without sign, scale or offset.
JointMappingConfig joints_in_wire_order(std::span<const std::string> joints);

/// A 7-axis Yaskawa robot as MotoROS sends it: S L E U R B T, base to tool, which is the model's own order.
/// Error: JointMappingError::wrong_joint_count.
Result<JointMappingConfig> yaskawa_7axis_wire(std::span<const std::string> model_joints);

/// JointMappingError::pendant_order when a model of 7 joints is mapped as if the wire carried the teach
/// pendant's order S L U R B T E. Not always a mistake (another controller may do so): the caller decides.
std::optional<Error> find_pendant_order(const JointMapping& mapping);

}  // namespace calibrd
