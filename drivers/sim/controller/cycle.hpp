// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "drivers/sim/controller/messages.hpp"
#include "drivers/sim/controller/rtde_session.hpp"
#include "drivers/sim/world/controller_settings.hpp"
#include "drivers/sim/world/state.hpp"

namespace calibrd::sim {

/// What a controller reported when it froze.
struct Frozen {
  Joints joints{};
  std::int64_t at_ns = 0;
};

/// What a controller that speaks simple_message sends in one cycle, one element per send() call, decided
/// without I/O. `cycle` counts them from 0.
std::vector<Bytes> controller_cycle(const WorldState& world, const ControllerSettings& settings,
                                    const Frozen& frozen, std::int64_t now_ns, std::uint64_t cycle);

/// What a controller that speaks RTDE reports now; its clock began at `started_ns`.
RtdeState rtde_state(const WorldState& world, const ControllerSettings& settings, const Frozen& frozen,
                     std::int64_t now_ns, std::int64_t started_ns);

/// What the controller reports now: true joints of latency ago, less the zero errors, in the controller's
/// terms.
Joints reported_joints(const WorldState& world, const ControllerSettings& settings, std::int64_t now_ns);

}  // namespace calibrd::sim
