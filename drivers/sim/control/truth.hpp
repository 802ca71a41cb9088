// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/json.hpp>

#include "drivers/sim/control/live_world.hpp"

namespace calibrd::sim {

/// Everything the daemon under test must not know: true poses, joints and errors at a time of
/// CLOCK_MONOTONIC.
boost::json::object truth_json(const Cell& cell, const WorldState& state, std::int64_t at_ns);

}  // namespace calibrd::sim
