// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <iostream>
#include <map>

#include "drivers/sim/app/bench.hpp"
#include "drivers/sim/app/record.hpp"
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
  run->add_option("--motion-port", options.motion_port, "motion port of the robot controller, 0 = any")
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
  bench->add_option("--frames", options.frames, "how many frames")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  return bench;
}

CLI::App* add_capture(CLI::App& app, calibrd::sim::RecordOptions& options) {
  using calibrd::sim::Level;
  static const std::map<std::string, Level> levels{
      {"clean", Level::clean}, {"cell", Level::cell}, {"field", Level::field}};
  CLI::App* capture =
      app.add_subcommand("capture", "record random cells into capture/1 folders with truth.json");
  capture->add_option("OUT_DIR", options.folder, "folder to write, absent or empty")->required();
  capture->add_option("--urdf", options.urdfs, "robot; may be repeated, the seed then chooses")->required();
  capture->add_option("--models", options.models, "folder that holds packages with meshes; may be repeated");
  capture->add_option("--urdf-reference", options.urdf_reference, "what capture.json says of the URDF");
  capture->add_option("--seed", options.seed, "of the first scene")->capture_default_str();
  capture->add_option("--scenes", options.scenes, "how many; more than one: OUT_DIR/scene_SEED")
      ->capture_default_str();
  capture->add_option("--postures", options.capture.postures, "views per scene")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  capture->add_option("--level", options.capture.level, "clean, cell or field")
      ->transform(CLI::CheckedTransformer(levels));
  capture->add_option("--min-distance", options.capture.min_distance_m, "m")->capture_default_str();
  capture->add_option("--max-distance", options.capture.max_distance_m, "m")->capture_default_str();
  capture->add_option("--min-robot-pixels", options.capture.min_robot_pixels, "on average over the views")
      ->capture_default_str();
  capture->add_flag("--distorted", options.distorted, "with the lens of a real Kinect v2");
  return capture;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"calibrd-sim: a robot cell that is not there, down to its wires"};
  calibrd::sim::RunOptions run_options;
  calibrd::sim::BenchOptions bench_options;
  calibrd::sim::RecordOptions record_options;
  add_run(app, run_options);
  const CLI::App* capture = add_capture(app, record_options);
  const CLI::App* bench = add_bench(app, bench_options);
  app.require_subcommand(1);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kUnusableInput;
  }
  if (bench->parsed()) return finish(calibrd::sim::run_bench(bench_options));
  if (capture->parsed()) return finish(calibrd::sim::record_captures(record_options));
  return finish(calibrd::sim::run_cell(run_options));
}
