// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <vector>

#include "core/sensing/images.hpp"

namespace calibrd {

/// One posture of the robot as one sensor saw it. The joints are those of the frame's time: who makes a view
/// has made sure of that (robot still, or interpolated with a known offset).
struct View {
  DepthImage depth;
  std::optional<GreyImage> image;           ///< same pixel grid as the depth
  std::vector<double> joint_positions_rad;  ///< RobotModel::position_names() order
  double stamp_s = 0;
  bool is_moving = false;  ///< the robot moved, or may have: its joints are right as far as the time is known
};

}  // namespace calibrd
