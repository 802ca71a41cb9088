// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "core/base/result.hpp"
#include "core/geometry/pose.hpp"

namespace calibrd {

class RobotModel;

/// The frame in which a robot's controller gives poses, as a link of the model that stands still to the base.
struct ControllerFrame {
  std::string link;
  Pose T_base_controller = Pose::Identity();  ///< m
};

/// The frame of the link of that name. Errors: RobotModelError::unknown_link, which names the nearest one,
/// and link_moves, which names a joint between the link and the base.
Result<ControllerFrame> find_controller_frame(const RobotModel& model, std::string_view link);

}  // namespace calibrd
