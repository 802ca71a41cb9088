// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/drift/background_map.hpp"
#include "core/geometry/pose.hpp"

namespace calibrd {

/// Where a sensor that was moved far sees the remembered background from.
struct BackgroundAlignment {
  Pose T_learnt_now = Pose::Identity();    ///< from the sensor now to where it was when the map was learnt
  Matrix6d covariance = Matrix6d::Zero();  ///< of its perturbation, axes of the sensor as learnt
  /// Share of the frame's points that meet a remembered plane (not an edge, not what was never seen) ...
  double on_planes = 0;
  double inliers = 0;  ///< ... and of these, that lie on it
  /// Share of the frame's points that would lie on the background, had the sensor not moved.
  double in_place = 0;
};

/// Pulls a frame onto the background by projective point-to-plane pairs, kernel narrowing from 0.2 m: for
/// knocks of some centimetres and degrees, after which pixel by pixel nothing is where it was. `depth_m`: of
/// the frame, on the map's cells. `robot` as for match(), of the robot seen from where the sensor was; may be
/// empty. Nothing when too little of the frame lies on the background from anywhere near.
std::optional<BackgroundAlignment> align_background(const BackgroundMap& map, std::span<const float> depth_m,
                                                    std::span<const std::uint8_t> robot, const Pose& start);

}  // namespace calibrd
