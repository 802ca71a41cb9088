// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "core/geometry/pose.hpp"
#include "core/global/distance_field.hpp"

namespace calibrd {

/// One posture: where the robot's surface is (base frame) and what the sensor saw of it (sensor frame, m).
struct PostureEvidence {
  const DistanceField* surface_base;
  std::span<const Eigen::Vector3f> points_sensor;
};

struct FieldFitSettings {
  double start_kernel_m = 0.25;  ///< distances beyond it count little at first (Geman-McClure) ...
  double end_kernel_m = 0.05;    ///< ... and beyond this in the end
  int iterations = 10;
  std::size_t stride = 1;  ///< every stride-th point
};

struct FieldFit {
  Pose T_base_sensor = Pose::Identity();
  double cost = 1;  ///< 0 = every point lies on the surface, 1 = none is near it
};

/// Moves the sensor until the points it saw lie on the robot's surface in every posture: Gauss-Newton on the
/// distance field, annealed robust kernel. Looks at distances alone, so a pose it likes may still see through
/// the robot: that is for render_score() to judge.
FieldFit fit_to_fields(std::span<const PostureEvidence> postures, const Pose& start,
                       const FieldFitSettings& settings);

}  // namespace calibrd
