// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "drivers/sim/controller/messages.hpp"
#include "drivers/sim/world/controller_settings.hpp"
#include "drivers/sim/world/state.hpp"

namespace calibrd::sim {

/// What a controller sends in one cycle, one element per send() call, decided without I/O.
/// `frozen`: the joints to report while the controller is frozen.
std::vector<Bytes> controller_cycle(const WorldState& world, const ControllerSettings& settings,
                                    const Joints& frozen, std::int64_t now_ns);

/// What the controller reports now: true joints of latency ago, less the zero errors.
Joints reported_joints(const WorldState& world, const ControllerSettings& settings, std::int64_t now_ns);

}  // namespace calibrd::sim
