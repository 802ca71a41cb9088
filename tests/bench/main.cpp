// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <vector>

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

CLI::App* add_render(CLI::App& app, RenderOptions& render) {
  CLI::App* command = app.add_subcommand("render", "time the virtual sensor, joint update included");
  command->add_option("URDF", render.urdf)->required();
  command->add_option("--models", render.models);
  command->add_option("--distance-m", render.distance_m)->check(CLI::Range(0.1, 100.0));
  command->add_option("--runs", render.runs)->check(CLI::Range(1, 1000000));
  return command;
}

void add_random_scenes(CLI::App& command, RandomScenes& scenes) {
  command.add_option("--robot", scenes.urdfs, "URDF; may be repeated, the scenes take them in turn")
      ->required();
  command.add_option("--models", scenes.models, "folders to look robot models up in");
  command.add_option("--first-seed", scenes.first_seed);
}

CLI::App* add_scenes(CLI::App& app, ScenesOptions& scenes) {
  CLI::App* command =
      app.add_subcommand("scenes", "calibrate random simulated scenes and hold the truth against it");
  add_random_scenes(*command, scenes);
  command->add_option("--level", scenes.level)->check(CLI::IsMember({"clean", "cell", "field", "mixed"}));
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

CLI::App* add_step(CLI::App& app, StepOptions& step) {
  CLI::App* command =
      app.add_subcommand("step", "time from a controller's packet to the virtual cell in step with it");
  command->add_option("URDF", step.urdf)->required();
  command->add_option("--models", step.models);
  command->add_option("--port", step.port, "of a controller on this machine")->check(CLI::Range(1, 65535));
  command->add_option("--seconds", step.seconds)->check(CLI::Range(1, 86400));
  return command;
}

CLI::App* add_moving(CLI::App& app, MovingBenchOptions& moving) {
  CLI::App* command =
      app.add_subcommand("moving", "calibrate from views of a moving robot, and of the same postures still");
  add_random_scenes(*command, moving);
  command->add_option("--level", moving.level)->check(CLI::IsMember({"clean", "cell", "field"}));
  command->add_option("--scenes", moving.scenes)->check(CLI::Range(1, 1000000));
  command->add_option("--postures", moving.postures)->check(CLI::Range(2, 1000));
  command->add_option("--speed-m-s", moving.speed_m_s, "of the robot's fastest point")
      ->check(CLI::Range(0.02, 2.0));
  command->add_option("--offset-ms", moving.offset_ms, "how much later frames arrive than joints")
      ->check(CLI::Range(-150.0, 250.0));
  command->add_option("--jitter-ms", moving.jitter_ms)->check(CLI::Range(0.0, 50.0));
  command->add_option("--learn-s", moving.learn_s, "motion seen before the views are taken")
      ->check(CLI::Range(1.0, 3600.0));
  command->add_flag("--uncorrected", moving.also_uncorrected, "also with the offset left out");
  return command;
}

CLI::App* add_knocked(CLI::App& app, KnockedOptions& knocked) {
  CLI::App* command =
      app.add_subcommand("knocked", "calibrate while the sensor is knocked between two postures");
  add_random_scenes(*command, knocked);
  command->add_option("--scenes", knocked.scenes)->check(CLI::Range(1, 1000000));
  command->add_option("--postures", knocked.postures)->check(CLI::Range(2, 1000));
  command->add_option("--shift-mm", knocked.shift_mm)->check(CLI::Range(0.0, 1000.0));
  command->add_option("--turn-mrad", knocked.turn_mrad)->check(CLI::Range(0.0, 1000.0));
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
  add_random_scenes(*command, watch);
  command->add_option("--scenes", watch.scenes, "seeds; not each has a scene that can be watched")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--event", watch.event, "only of this kind: the verdict that is right for it");
  return command;
}

CLI::App* add_watch_hours(CLI::App& app, WatchHoursOptions& hours) {
  CLI::App* command = app.add_subcommand("watch-hours", "watch sensors that stand in cells at work");
  add_random_scenes(*command, hours);
  command->add_option("--cells", hours.cells)->check(CLI::Range(1, 100000));
  command->add_option("--hours", hours.hours, "of all cells together")->check(CLI::Range(0.0, 1e5));
  command->add_option("--innovations", hours.innovations, "file to write them to, for watch-tail");
  return command;
}

CLI::App* add_watch_tail(CLI::App& app, WatchTailOptions& tail) {
  CLI::App* command = app.add_subcommand("watch-tail", "recorded innovations through the test alone");
  command->add_option("INNOVATIONS", tail.innovations, "files of watch-hours")->required();
  command->add_option("--hours", tail.hours, "to draw from their blocks")->check(CLI::Range(0.0, 1e6));
  command->add_option("--block-s", tail.block_s)->check(CLI::Range(1.0, 1e6));
  command->add_option("--seed", tail.seed);
  return command;
}

CLI::App* add_watch_creep(CLI::App& app, WatchCreepOptions& creep) {
  CLI::App* command = app.add_subcommand("watch-creep", "watch sensors that creep while they warm up");
  add_random_scenes(*command, creep);
  command->add_option("--cells", creep.cells)->check(CLI::Range(1, 100000));
  command->add_option("--per-hour-mm", creep.per_hour_mm, "or mrad")->check(CLI::Range(0.01, 1e3));
  command->add_option("--seen-s", creep.seen_s, "of every minute")->check(CLI::Range(0.1, 60.0));
  return command;
}

CLI::App* add_pairs(CLI::App& app, PairsOptions& pairs) {
  CLI::App* command =
      app.add_subcommand("pairs", "calibrate two sensors of random scenes, check them against each other");
  add_random_scenes(*command, pairs);
  command->add_option("--scenes", pairs.scenes)->check(CLI::Range(1, 1000000));
  command->add_option("--postures", pairs.postures)->check(CLI::Range(2, 1000));
  return command;
}

int run_checked_scenes(const ScenesOptions& scenes) {
  if (!scenes.bound || (scenes.noise_only && scenes.depth_only)) return run_scenes(scenes);
  return stop("--bound holds for noise alone: give --noise-only and --depth-only too");
}

struct Command {
  const CLI::App* declared;
  std::function<int()> run;
};

template <class Options, class Run>
Command command(CLI::App& app, CLI::App* (*declare)(CLI::App&, Options&), Run run) {
  const auto options = std::make_shared<Options>();
  const CLI::App* declared = declare(app, *options);
  return {declared, [options, run] { return run(*options); }};
}

}  // namespace

int main(int argc, char** argv) {
  calibrd::keep_freed_memory();
  CLI::App app("Measures calibrd. Prints JSON lines.");
  app.require_subcommand(1);
  const std::vector<Command> commands{command(app, add_fine, run_fine),
                                      command(app, add_global, run_global),
                                      command(app, add_render, run_render),
                                      command(app, add_scenes, run_checked_scenes),
                                      command(app, add_register, run_register),
                                      command(app, add_watch, run_watch),
                                      command(app, add_watch_tail, run_watch_tail),
                                      command(app, add_watch_creep, run_watch_creep),
                                      command(app, add_watch_hours, run_watch_hours),
                                      command(app, add_pairs, run_pairs),
                                      command(app, add_track, run_track),
                                      command(app, add_step, run_step),
                                      command(app, add_knocked, run_knocked),
                                      command(app, add_moving, run_moving)};
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  for (const Command& each : commands)
    if (each.declared->parsed()) return each.run();
  return 2;
}
