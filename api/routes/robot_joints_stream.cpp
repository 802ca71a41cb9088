// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/robot_joints_stream.hpp"

#include "api/json/json_text.hpp"
#include "api/routes/cell_json.hpp"

namespace calibrd::api {
namespace {

constexpr auto kPeriod = std::chrono::microseconds(33'333);

}  // namespace

std::string RobotJointsStream::next() {
  const auto now = std::chrono::steady_clock::now();
  if (now < due_) return {};
  // In step with the clock and not with the last event, so that what is late once does not slow it down.
  due_ = std::max(due_ + kPeriod, now - kPeriod);
  return "event: joints\ndata: " + json_line(live_joints_json(service_.robot())) + "\n\n";
}

}  // namespace calibrd::api
