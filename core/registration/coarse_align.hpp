// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "core/registration/registration_view.hpp"

namespace calibrd {

struct CoarseSettings {
  double start_kernel_m = 0.15;  ///< correspondences further apart than this have no weight at first ...
  double end_kernel_m = 0.03;    ///< ... and than this in the end
  int iterations = 16;
  int reduction = 4;           ///< the prediction is made on a grid this many times coarser
  double crop_margin_m = 0.3;  ///< measured points further from the robot's bounding box are left out
};

/// Pulls a rough pose (some centimetres, some degrees off) to within reach of the projective refinement:
/// nearest measured neighbour of every *visible* model point, point-to-plane, annealed kernel, all views
/// jointly. Model to measurement, not the other way round: clutter then attracts nothing.
Pose coarse_align(std::span<const RegistrationView> views, const CameraModel& camera,
                  const Pose& guess_T_base_sensor, const CoarseSettings& settings);

}  // namespace calibrd
