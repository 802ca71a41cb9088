// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <iostream>

#include "bench.hpp"
#include "core/base/memory.hpp"

namespace {

using namespace calibrd::bench;

CLI::App* add_fine(CLI::App& app, FineOptions& fine) {
  CLI::App* command =
      app.add_subcommand("fine", "calibrate a recording from a guess that is off by a known amount");
  command->add_option("CAPTURE_DIR", fine.capture_dir)->required();
  command->add_option("--models", fine.models, "folders to look robot models up in");
  command->add_option("--around", fine.around, "pose file to start around (default: truth.json)");
  command->add_option("--offset-mm", fine.offset_mm)->check(CLI::Range(0.0, 1e4));
  command->add_option("--offset-deg", fine.offset_deg)->check(CLI::Range(0.0, 180.0));
  command->add_option("--seed", fine.seed);
  command->add_option("--runs", fine.runs)->check(CLI::Range(1, 1000000));
  command->add_flag("--depth-only", fine.depth_only);
  command->add_flag("--vary", fine.vary, "each run starts from another guess, up to the offset away");
  return command;
}

CLI::App* add_global(CLI::App& app, GlobalOptions& options) {
  CLI::App* command = app.add_subcommand("global", "calibrate a recording from nothing");
  command->add_option("CAPTURE_DIR", options.capture_dir)->required();
  command->add_option("--models", options.models, "folders to look robot models up in");
  command->add_option("--runs", options.runs)->check(CLI::Range(1, 1000000));
  command->add_flag("--depth-only", options.depth_only);
  command->add_flag("--starts", options.starts, "print the hypotheses of the search first");
  return command;
}

void add_render(CLI::App& app, RenderOptions& render) {
  CLI::App* command = app.add_subcommand("render", "time the virtual sensor, joint update included");
  command->add_option("URDF", render.urdf)->required();
  command->add_option("--models", render.models);
  command->add_option("--distance-m", render.distance_m)->check(CLI::Range(0.1, 100.0));
  command->add_option("--runs", render.runs)->check(CLI::Range(1, 1000000));
}

CLI::App* add_scenes(CLI::App& app, ScenesOptions& scenes) {
  CLI::App* command =
      app.add_subcommand("scenes", "calibrate random simulated scenes and hold the truth against it");
  command->add_option("--robot", scenes.urdfs, "URDF; may be repeated, the scenes take them in turn")
      ->required();
  command->add_option("--models", scenes.models, "folders to look robot models up in");
  command->add_option("--level", scenes.level)->check(CLI::IsMember({"clean", "cell", "field", "mixed"}));
  command->add_option("--first-seed", scenes.first_seed);
  command->add_option("--scenes", scenes.scenes)->check(CLI::Range(1, 1000000));
  command->add_option("--postures", scenes.postures, "K[,K...]: how many views to calibrate from")
      ->delimiter(',')
      ->check(CLI::Range(1, 1000));
  command->add_option("--guess-mm", scenes.guess_mm, "how far off the guess is (default: no guess)")
      ->check(CLI::Range(0.0, 1e4));
  command->add_option("--guess-deg", scenes.guess_deg)->check(CLI::Range(0.0, 180.0));
  command->add_flag("--depth-only", scenes.depth_only);
  command->add_flag("--noise-only", scenes.noise_only, "the robot alone, its depth noisy and nothing else");
  command->add_flag("--bound", scenes.bound, "add the Cramer-Rao bound; needs --noise-only and --depth-only");
  command->add_option("--jobs", scenes.jobs, "scenes at a time; more than 1 spoils time_ms")
      ->check(CLI::Range(1, 256));
  return command;
}

CLI::App* add_register(CLI::App& app, RegisterOptions& clouds) {
  CLI::App* command = app.add_subcommand("register", "register two PLY clouds, starting as they lie");
  command->add_option("--source", clouds.source)->required();
  command->add_option("--target", clouds.target)->required();
  command->add_option("--runs", clouds.runs)->check(CLI::Range(1, 1000000));
  command->add_option("--threads", clouds.threads)->check(CLI::Range(1, 1000000));
  return command;
}

CLI::App* add_track(CLI::App& app, TrackOptions& track) {
  CLI::App* command =
      app.add_subcommand("track", "update a pose that is off by a little by one frame, for every view");
  command->add_option("CAPTURE_DIR", track.capture_dir)->required();
  command->add_option("--models", track.models, "folders to look robot models up in");
  command->add_option("--runs", track.runs, "starts per view")->check(CLI::Range(1, 1000000));
  command->add_option("--offset-mm", track.offset_mm)->check(CLI::Range(0.0, 1e4));
  command->add_option("--offset-deg", track.offset_deg)->check(CLI::Range(0.0, 180.0));
  command->add_option("--seed", track.seed);
  command->add_option("--stride", track.stride)->check(CLI::Range(1, 1000000));
  command->add_option("--steps", track.steps)->check(CLI::Range(1, 1000000));
  command->add_option("--threads", track.threads)->check(CLI::Range(1, 1000000));
  return command;
}

CLI::App* add_watch(CLI::App& app, WatchOptions& watch) {
  CLI::App* command =
      app.add_subcommand("watch", "stage events before watched sensors and tell the verdicts");
  command->add_option("--robot", watch.urdfs, "URDF; may be repeated, the scenes take them in turn")
      ->required();
  command->add_option("--models", watch.models, "folders to look robot models up in");
  command->add_option("--first-seed", watch.first_seed);
  command->add_option("--events", watch.events)->check(CLI::Range(1, 1000000));
  return command;
}

CLI::App* add_pairs(CLI::App& app, PairsOptions& pairs) {
  CLI::App* command =
      app.add_subcommand("pairs", "calibrate two sensors of random scenes, check them against each other");
  command->add_option("--robot", pairs.urdfs, "URDF; may be repeated, the scenes take them in turn")
      ->required();
  command->add_option("--models", pairs.models, "folders to look robot models up in");
  command->add_option("--first-seed", pairs.first_seed);
  command->add_option("--scenes", pairs.scenes)->check(CLI::Range(1, 1000000));
  command->add_option("--postures", pairs.postures)->check(CLI::Range(2, 1000));
  return command;
}

}  // namespace

int main(int argc, char** argv) {
  calibrd::keep_freed_memory();
  CLI::App app("Measures calibrd. Prints JSON lines.");
  app.require_subcommand(1);
  FineOptions fine;
  GlobalOptions global;
  RenderOptions render;
  ScenesOptions scenes;
  RegisterOptions clouds;
  TrackOptions track;
  WatchOptions watch;
  PairsOptions pairs;
  const CLI::App* fine_command = add_fine(app, fine);
  const CLI::App* global_command = add_global(app, global);
  add_render(app, render);
  const CLI::App* scenes_command = add_scenes(app, scenes);
  const CLI::App* register_command = add_register(app, clouds);
  const CLI::App* watch_command = add_watch(app, watch);
  const CLI::App* pairs_command = add_pairs(app, pairs);
  const CLI::App* track_command = add_track(app, track);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (pairs_command->parsed()) return run_pairs(pairs);
  if (register_command->parsed()) return run_register(clouds);
  if (watch_command->parsed()) return run_watch(watch);
  if (track_command->parsed()) return run_track(track);
  if (global_command->parsed()) return run_global(global);
  if (scenes.bound && !(scenes.noise_only && scenes.depth_only)) {
    std::cerr << "calibrd-bench: --bound holds for noise alone: give --noise-only and --depth-only too\n";
    return 2;
  }
  if (scenes_command->parsed()) return run_scenes(scenes);
  return fine_command->parsed() ? run_fine(fine) : run_render(render);
}
