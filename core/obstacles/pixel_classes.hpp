// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "core/drift/background_map.hpp"

namespace calibrd {

/// What a pixel shows. The numbers are those of the HTTP interface.
enum class PixelClass : std::uint8_t {
  nothing = 0,     ///< no measurement
  unknown = 1,     ///< neither robot, nor is it remembered what else is here
  robot = 2,       ///< at the robot's surface, or so near its outline that it may be
  background = 3,  ///< where the background was remembered
  unexpected = 4   ///< neither: before the robot or the background, or behind it
};

/// A frame and what the same pixels are known to see.
struct PixelEvidence {
  const DepthImage& depth;
  int step;                         ///< every step-th pixel is looked at, in both directions
  const PixelRays& rays;            ///< of the camera subsampled by it
  const VirtualMeasurement& robot;  ///< on the same grid; empty: nothing is known of it
  const BackgroundMap* background;  ///< nullptr: none is remembered
};

/// Row-major, of the grid of `rays`. For people to look at: which points mean anything to a calibration is
/// decided elsewhere, and what stands in the cell by ObstacleFinder.
std::vector<PixelClass> classify_pixels(const PixelEvidence& evidence);

}  // namespace calibrd
