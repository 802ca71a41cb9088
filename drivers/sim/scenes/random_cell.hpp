// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "core/base/result.hpp"
#include "drivers/sim/world/cell.hpp"
#include "drivers/sim/world/random.hpp"
#include "drivers/sim/world/state.hpp"

namespace calibrd::sim {

enum class Level {
  clean,  ///< the robot alone, noise alone
  cell,   ///< bench, boxes, posts, walls, at times a second robot or a person; biased depth, flying pixels,
          ///< drop-outs
  field,  ///< cell, and the joints reported are off by constant zeros
};

/// A cell furnished at random around a robot, and a sensor with errors of its own. The robot stands in no
/// posture yet, the sensor (sensors[0]) nowhere yet.
struct FurnishedCell {
  Cell cell;
  WorldState state;
};

/// The same for the same `random`. `camera`: the sensor's.
FurnishedCell furnish(const Robot& robot, Level level, const CameraParameters& camera, Random& random);

}  // namespace calibrd::sim
