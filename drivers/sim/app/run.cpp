// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/app/run.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <iostream>

#include "drivers/sim/control/control_server.hpp"

namespace calibrd::sim {
namespace {

namespace asio = boost::asio;

constexpr std::chrono::milliseconds kBeat{200};

/// Tells drivers that the simulator lives, for as long as `io` runs.
void keep_beating(asio::steady_timer& timer, LiveWorld& world) {
  world.beat();
  timer.expires_after(kBeat);
  timer.async_wait([&](boost::system::error_code failed) {
    if (!failed) keep_beating(timer, world);
  });
}

Status announce(const RunOptions& options, const ControllerServer& controller, const MotionServer& motion,
                const ControlServer& control) {
  const std::string line = "ready controller=127.0.0.1:" + std::to_string(controller.port()) +
                           " motion=127.0.0.1:" + std::to_string(motion.port()) +
                           " control=127.0.0.1:" + std::to_string(control.port()) +
                           " world=" + options.world_file.string();
  std::cout << line << std::endl;
  if (options.ready_file.empty()) return Done{};
  const std::filesystem::path draft = options.ready_file.string() + ".part";
  std::ofstream(draft) << line << '\n';
  std::error_code failed;
  std::filesystem::rename(draft, options.ready_file, failed);  // whoever waits for the file finds it whole
  if (failed) return sim_error(SimError::world_unwritable, options.ready_file.string());
  return Done{};
}

}  // namespace

Status run_cell(const RunOptions& options) {
  auto description = read_description(options.description, {options.urdf, options.models});
  if (!description) return description.error();
  auto world = LiveWorld::open(*description, options.world_file);
  if (!world) return world.error();

  asio::io_context io(1);
  ControllerServer controller(
      io, [&world]() -> const WorldState& { return world->state(); }, description->controller);
  MotionServer motion(io,
                      {[&world]() -> const WorldState& { return world->state(); },
                       [&world](const WorldState& state) { world->change(state); }},
                      controller);
  ControlRoutes routes(*world, controller, &motion);
  ControlServer control(io, routes);
  if (auto listening = controller.listen(options.controller_port); !listening) return listening;
  if (auto listening = motion.listen(options.motion_port); !listening) return listening;
  if (auto listening = control.listen(options.control_port); !listening) return listening;

  asio::steady_timer beat(io);
  keep_beating(beat, *world);
  asio::signal_set signals(io, SIGTERM, SIGINT);
  signals.async_wait([&io](boost::system::error_code, int) { io.stop(); });
  if (auto announced = announce(options, controller, motion, control); !announced) return announced;
  io.run();
  return Done{};
}

}  // namespace calibrd::sim
