// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/drift/background_match.hpp"

namespace calibrd {

/// What one cell of a background's grid shows that is neither robot nor background.
enum class Foreign : std::uint8_t {
  no,
  before_known,         ///< something stands in front of the background that is remembered, or of the robot
  background_not_known  ///< nothing is remembered here, nor does what lies around go on to here
};

/// Depth (m) of a pixel and those around it that lie on one surface with it; 0 where fewer than five of the
/// eight do: such a pixel flies between foreground and background.
double surface_depth_m(const DepthImage& depth, const CameraModel& camera, int x, int y);

/// What is expected on the cells of a background's grid in one frame.
struct ExpectedCells {
  const BackgroundMap& background;
  std::span<const CellState> states;  ///< of this frame, see BackgroundMatcher
  std::vector<float> robot_m;  ///< depth of what of the robot is nearest around a cell; 0 = no robot there
};

/// `mask`, `prediction`: see RobotMask.
std::vector<float> robot_around(std::span<const std::uint8_t> mask, const VirtualMeasurement& prediction);

/// What the pixel shows, at `measured_m`, may be robot, or a surface that is remembered around it.
bool may_be_known(const ExpectedCells& expected, const CameraModel& camera, int x, int y, double measured_m);

/// Row-major cells of the background's grid.
std::vector<Foreign> foreign_cells(const ExpectedCells& expected, const CameraModel& camera,
                                   const DepthImage& depth);

}  // namespace calibrd
