// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// From a controller's packet in this machine's network stack to the virtual cell standing at its joints.
#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <cstdio>

#include "core/virtual_cell/virtual_cell.hpp"
#include "drivers/robot/state_client.hpp"
#include "server/live_cell/live_robot.hpp"
#include "tests/bench/bench.hpp"

namespace calibrd::bench {
namespace {

double percentile(std::vector<double>& values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

double milliseconds_since(Clock::time_point time) {
  return std::chrono::duration<double, std::milli>(Clock::now() - time).count();
}

}  // namespace

int run_step(const StepOptions& options) {
  auto model = RobotModel::load(options.urdf, {options.models, ""});
  if (!model) return stop(model.error().message());
  auto mapping = JointMapping::make(joints_in_wire_order(model->position_names()), model->position_names());
  if (!mapping) return stop(mapping.error().message());
  LiveRobot robot(*model, *std::move(mapping), {}, Clock::duration(0), {});
  VirtualCell cell(*model);
  std::vector<double> known_ms, placed_ms;
  auto events = robot.events();
  events.on_joints = [&, take = events.on_joints](const ControllerJoints& joints) {
    take(joints);
    known_ms.push_back(milliseconds_since(joints.stamp));
    cell.set_joints(robot.newest_joints()->positions_rad);
    placed_ms.push_back(milliseconds_since(joints.stamp));
  };
  boost::asio::io_context io;
  StateClientSettings settings;
  settings.host = "127.0.0.1";
  settings.port = options.port;
  auto client = StateClient::create(io.get_executor(), settings, std::move(events));
  if (!client) return stop(client.error().message());
  client->start();
  io.run_for(std::chrono::seconds(options.seconds));
  client->stop();
  if (placed_ms.empty()) return stop("no joints have come: " + client->health().reason);
  std::printf(
      "{\"packets\": %zu, \"known_p50_ms\": %.3f, \"known_p99_ms\": %.3f, \"in_step_p50_ms\": %.3f, "
      "\"in_step_p99_ms\": %.3f, \"in_step_max_ms\": %.3f}\n",
      placed_ms.size(), percentile(known_ms, 0.5), percentile(known_ms, 0.99), percentile(placed_ms, 0.5),
      percentile(placed_ms, 0.99), *std::ranges::max_element(placed_ms));
  return 0;
}

}  // namespace calibrd::bench
