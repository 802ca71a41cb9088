// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Sensors that creep: how far they have come when the watch says so.
#include <tbb/global_control.h>

#include <boost/json.hpp>
#include <cstdio>

#include "tests/bench/watched_sensor.hpp"

namespace calibrd::bench {
namespace {

namespace json = boost::json;

constexpr double kPeriod_s = 60;  // of which `seen_s` are seen
constexpr double kFirst_s = 5;    // what a watch sees of a sensor that it has just learnt
constexpr double kCreepWarmup_m = 0.007, kCreepWarmup_s = 600;
constexpr double kFarthest = 0.005;  // m or rad: it will not be found any more

/// The sensor's way: `per_hour` (m or rad) along or about one direction.
struct Creep {
  Pose T_base_sensor;
  Eigen::Vector3d direction;
  bool turns = false;
  double per_hour = 0.001;

  double way(double seconds) const { return per_hour * seconds / 3600; }
  Pose after(double seconds) const {
    Pose pose = T_base_sensor;
    if (turns)
      pose.linear() = exp_so3(way(seconds) * direction) * pose.linear();
    else
      pose.translation() += way(seconds) * direction;
    return pose;
  }
};

json::object creep(const CalibratedScenes::One& one, const std::shared_ptr<const sim::SensorTables>& tables,
                   std::uint64_t seed, const WatchCreepOptions& options) {
  RunningCell cell(one.scene, tables, seed);
  WatchedSensor sensor(one.scene, one.calibration, {});
  const Creep way{cell.T_base_sensor(), cell.random_direction(), cell.random().chance(0.5),
                  options.per_hour_mm * 1e-3};
  auto& depth = cell.state().sensors[0].depth;  // calibrated cold
  depth.offset_m += kCreepWarmup_m;
  depth.warmup_m = -kCreepWarmup_m;
  depth.warmup_s = kCreepWarmup_s;
  bool moved = false, bias = false;
  double next_s = 0;
  while (!moved && way.way(cell.time_s()) < kFarthest) {
    cell.put_sensor(way.after(cell.time_s()));
    const double until_s = cell.time_s() + (next_s == 0 ? kFirst_s : options.seen_s);
    while (!moved && cell.time_s() < until_s) {
      const auto verdict = sensor.see(cell.next());
      moved = verdict == DriftVerdict::sensor_moved;
      bias = bias || verdict == DriftVerdict::depth_bias_changed;
    }
    next_s += kPeriod_s;
    if (!moved) cell.skip(next_s - cell.time_s());
  }
  const auto& report = sensor.watch().report();
  return {{"seed", seed},
          {"robot", one.scene.robot->name},
          {"turns", way.turns},
          {"found", moved},
          {"at", 1e3 * way.way(cell.time_s())},  // mm or mrad
          {"bias_told", bias},
          {"offset_mm", 1e3 * report.depth_offset_change_m},
          {"sigma_mm", 1e3 * report.shift_sigma_m},
          {"sigma_mrad", 1e3 * report.turn_sigma_rad},
          {"frames", sensor.frame_ms().size()}};
}

}  // namespace

int run_watch_creep(const WatchCreepOptions& options) {
  auto robots = read_scene_robots(options);
  if (!robots) return stop(robots.error().message());
  const CalibratedScenes scenes(*std::move(robots));
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 1);
  std::uint64_t cells = 0;
  for (std::uint64_t seed = options.first_seed; cells < options.cells; ++seed) {
    const auto one = scenes.get(seed);
    if (!one) continue;
    ++cells;
    std::printf("%s\n", json::serialize(creep(*one, scenes.tables(), seed, options)).c_str());
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace calibrd::bench
