// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "bench.hpp"

int main(int argc, char** argv) {
  using namespace calibrd::bench;
  CLI::App app("Measures calibrd. Prints JSON lines.");
  app.require_subcommand(1);

  FineOptions fine;
  CLI::App* fine_command =
      app.add_subcommand("fine", "calibrate a recording from a guess that is off by a known amount");
  fine_command->add_option("CAPTURE_DIR", fine.capture_dir)->required();
  fine_command->add_option("--models", fine.models, "folders to look robot models up in");
  fine_command->add_option("--around", fine.around, "pose file to start around (default: truth.json)");
  fine_command->add_option("--offset-mm", fine.offset_mm);
  fine_command->add_option("--offset-deg", fine.offset_deg);
  fine_command->add_option("--seed", fine.seed);
  fine_command->add_option("--runs", fine.runs);
  fine_command->add_flag("--depth-only", fine.depth_only);
  fine_command->add_flag("--vary", fine.vary, "each run starts from another guess, up to the offset away");

  RenderOptions render;
  CLI::App* render_command = app.add_subcommand("render", "time the virtual sensor, joint update included");
  render_command->add_option("URDF", render.urdf)->required();
  render_command->add_option("--models", render.models);
  render_command->add_option("--distance-m", render.distance_m);
  render_command->add_option("--runs", render.runs);

  RegisterOptions clouds;
  CLI::App* register_command =
      app.add_subcommand("register", "register two PLY clouds, starting as they lie");
  register_command->add_option("--source", clouds.source)->required();
  register_command->add_option("--target", clouds.target)->required();
  register_command->add_option("--runs", clouds.runs)->check(CLI::PositiveNumber);
  register_command->add_option("--threads", clouds.threads)->check(CLI::PositiveNumber);

  CLI11_PARSE(app, argc, argv);
  if (register_command->parsed()) return run_register(clouds);
  return fine_command->parsed() ? run_fine(fine) : run_render(render);
}
