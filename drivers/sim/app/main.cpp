// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <iostream>

#include "drivers/sim/app/bench.hpp"
#include "drivers/sim/app/run.hpp"

namespace {

constexpr int kUnusableInput = 2;

int finish(const calibrd::Status& status) {
  if (status) return 0;
  std::cerr << "calibrd-sim: " << status.error().message() << '\n';
  return kUnusableInput;
}

CLI::App* add_run(CLI::App& app, calibrd::sim::RunOptions& options) {
  CLI::App* run = app.add_subcommand("run", "run the simulated cell until SIGTERM");
  run->add_option("--world", options.description, "world description (JSON)")->required();
  run->add_option("--urdf", options.urdf, "robot, instead of the description's");
  run->add_option("--models", options.models, "folder that holds packages with meshes; may be repeated");
  run->add_option("--world-file", options.world_file, "shared world for the OpenNI2 driver")->required();
  run->add_option("--controller-port", options.controller_port, "port of the robot controller, 0 = any")
      ->capture_default_str();
  run->add_option("--control-port", options.control_port, "port of the control calls, 0 = any")
      ->capture_default_str();
  run->add_option("--ready-file", options.ready_file, "file to write the ready line to");
  return run;
}

CLI::App* add_bench(CLI::App& app, calibrd::sim::BenchOptions& options) {
  CLI::App* bench = app.add_subcommand("bench", "measure the CPU time of a simulated frame");
  bench->add_option("--world", options.description, "world description (JSON)")->required();
  bench->add_option("--urdf", options.urdf, "robot, instead of the description's");
  bench->add_option("--models", options.models, "folder that holds packages with meshes; may be repeated");
  bench->add_option("--frames", options.frames, "how many frames")->capture_default_str()->check(CLI::PositiveNumber);
  return bench;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"calibrd-sim: a robot cell that is not there, down to its wires"};
  calibrd::sim::RunOptions run_options;
  calibrd::sim::BenchOptions bench_options;
  add_run(app, run_options);
  const CLI::App* bench = add_bench(app, bench_options);
  app.require_subcommand(1);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kUnusableInput;
  }
  if (bench->parsed()) return finish(calibrd::sim::run_bench(bench_options));
  return finish(calibrd::sim::run_cell(run_options));
}
