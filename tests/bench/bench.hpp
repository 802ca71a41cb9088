// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/calibration/calibrate.hpp"
#include "core/calibration/track.hpp"
#include "core/capture/capture.hpp"
#include "core/robot/robot_model.hpp"

namespace calibrd::bench {

using Paths = std::vector<std::filesystem::path>;

/// A recording in memory, ready to be calibrated.
struct Input {
  RobotModel robot;
  CameraModel camera;
  std::vector<View> views;
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> check_points;  ///< p_sensor, p_base of truth.json
  std::optional<Pose> truth_T_base_sensor;  ///< of truth.json, where there is one
};

/// Reads it or ends the program with status 2 and a message.
Input load(const std::filesystem::path& capture_dir, const Paths& models);

/// A pose off by exactly that much: turned about the point 1.3 m ahead of the sensor about a random axis,
/// shifted in a random direction.
Pose off_by(const Pose& T_base_sensor, double offset_m, double angle_rad, std::mt19937_64& random);

double median(std::vector<double> values);

const char* name_of(Verdict verdict);

/// As JSON has it: what is not a number is null.
std::string shown(double value, int decimals);

/// Says on stderr why the program ends. Returns its status, 2.
int stop(const std::string& message);

struct FineOptions {
  std::filesystem::path capture_dir;
  Paths models;
  std::string around;  ///< pose file to start around instead of truth.json
  double offset_mm = 40, offset_deg = 4;
  std::uint64_t seed = 1;
  int runs = 1;
  bool depth_only = false;
  bool vary = false;  ///< another random guess for every run
};
int run_fine(const FineOptions& options);

/// One line about a result: verdict, error against `reference`, and what it says of itself.
void print_run(const Input& input, const CalibrationResult& result, const Pose& reference);

struct GlobalOptions {
  std::filesystem::path capture_dir;
  Paths models;
  int runs = 1;
  bool depth_only = false;
  bool starts = false;  ///< print the hypotheses of the search first
};
int run_global(const GlobalOptions& options);

struct RenderOptions {
  std::filesystem::path urdf;
  Paths models;
  double distance_m = 1.34;
  int runs = 200;
};
int run_render(const RenderOptions& options);

struct RegisterOptions {
  std::filesystem::path source, target;
  int runs = 50;
  int threads = 2;
};
int run_register(const RegisterOptions& options);

struct TrackOptions {
  std::filesystem::path capture_dir;
  Paths models;
  int runs = 20;
  double offset_mm = 2, offset_deg = 0.2;
  std::uint64_t seed = 1;
  int stride = TrackSettings{}.stride;
  int steps = TrackSettings{}.steps;
  int threads = 2;
};
int run_track(const TrackOptions& options);

struct StepOptions {
  std::filesystem::path urdf;
  Paths models;
  int port = 50241;  ///< of a controller on this machine
  int seconds = 30;
};
int run_step(const StepOptions& options);

/// Simulated scenes, one a seed.
struct RandomScenes {
  Paths urdfs;  ///< the scenes take the robots in turn
  Paths models;
  std::uint64_t first_seed = 1;
};

struct MovingBenchOptions : RandomScenes {
  std::string level = "cell";
  std::uint64_t scenes = 10;
  std::size_t postures = 10;
  double speed_m_s = 0.25;
  double offset_ms = 30, jitter_ms = 1;
  double learn_s = 30;  ///< of motion, for the time offset
  bool also_uncorrected = false;
};
int run_moving(const MovingBenchOptions& options);

struct KnockedOptions : RandomScenes {
  std::uint64_t scenes = 30;
  std::size_t postures = 6;
  double shift_mm = 5, turn_mrad = 5;
};
int run_knocked(const KnockedOptions& options);

struct ScenesOptions : RandomScenes {
  std::string level = "mixed";  ///< clean, cell, field, or all of them in turn
  std::uint64_t scenes = 10;
  std::vector<std::size_t> postures{10};      ///< simulated once, with the most; fewer: its first views
  std::optional<double> guess_mm, guess_deg;  ///< neither: calibrate without a guess
  bool depth_only = false;
  bool noise_only = false;  ///< the robot alone, its depth without bias, flying pixels and drop-outs
  bool bound = false;
  unsigned jobs = 1;
};
int run_scenes(ScenesOptions options);

struct WatchOptions : RandomScenes {
  std::uint64_t scenes = 3;
  std::string event;  ///< the verdict that is right for it; empty: one of each kind in every scene
};
int run_watch(const WatchOptions& options);

struct WatchHoursOptions : RandomScenes {
  std::uint64_t cells = 6;
  double hours = 1;                                 ///< of all cells together
  std::filesystem::path innovations = "/dev/null";  ///< to write them to
};
int run_watch_hours(const WatchHoursOptions& options);

struct WatchTailOptions {
  Paths innovations;
  double hours = 72, block_s = 60;
  std::uint64_t seed = 1;
};
int run_watch_tail(const WatchTailOptions& options);

struct WatchCreepOptions : RandomScenes {
  std::uint64_t cells = 8;
  double per_hour_mm = 1;  ///< or mrad
  double seen_s = 1;       ///< of every minute
};
int run_watch_creep(const WatchCreepOptions& options);

struct PairsOptions : RandomScenes {
  std::uint64_t scenes = 20;
  std::size_t postures = 6;
};
int run_pairs(const PairsOptions& options);

}  // namespace calibrd::bench
