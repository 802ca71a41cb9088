// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "tests/bench/scene.hpp"

namespace calibrd::bench {

/// Standard deviations that no unbiased estimator of the pose can go below (Cramér and Rao), from the depths
/// of the robot's surface away from edges: outlines and image left out.
struct PoseBound {
  double position_m = 0, rotation_rad = 0;  ///< sqrt of the trace of the 3×3 blocks, as calibrate() has it
};

struct PoseBounds {
  PoseBound range_known;  ///< the sensor's range is known to be right
  PoseBound range_free;   ///< range offset and scale are found beside the pose, from the priors below
  std::size_t pixels = 0;
};

inline constexpr double kOffsetPrior_m = 0.02, kScalePrior = 0.005;

/// Of the first `views` views. Derivatives are differences of rendered depths at poses beside the truth, the
/// noise is what the simulator truly adds, whole mm included: nothing of the estimator's covariance is in it.
PoseBounds pose_bounds(const Scene& scene, std::size_t views);

}  // namespace calibrd::bench
