// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Hours of a cell at work before sensors that stand: whatever the watch says of a move is a false alarm.
#include <tbb/global_control.h>

#include <boost/json.hpp>
#include <cmath>
#include <cstdio>
#include <map>

#include "tests/bench/innovations.hpp"
#include "tests/bench/watched_sensor.hpp"

namespace calibrd::bench {
namespace {

namespace json = boost::json;

constexpr double kWarmup_m = 0.007, kWarmup_s = 600;

/// Lets things happen at random moments, as they do in a cell at work.
class WorkingCell {
 public:
  explicit WorkingCell(RunningCell& cell) : cell_(cell) {
    auto& depth = cell.state().sensors[0].depth;  // as calibrated at first, then it warms up
    depth.offset_m += kWarmup_m;
    depth.warmup_m = -kWarmup_m;
    depth.warmup_s = kWarmup_s;
  }

  void happen() {
    const double now_s = cell_.time_s();
    sim::Random& random = cell_.random();
    if (now_s >= people_s_) {
      if (random.chance(0.5))
        cell_.send_people_away();
      else
        cell_.send_people();
      if (random.chance(0.1)) stand_close();
      people_s_ = now_s + random.uniform(4, 20);
    }
    if (now_s >= part_s_) {
      carries_ = !carries_;
      if (carries_)
        cell_.company().carry(
            Eigen::Vector3d(random.uniform(0.03, 0.4), random.uniform(0.03, 0.4), random.uniform(0.03, 0.4)));
      else
        cell_.company().carry(std::nullopt);
      part_s_ = now_s + random.uniform(3, 15);
    }
    if (now_s >= scene_s_) {
      const auto before = cell_.state().person;
      cell_.send_people_away();
      changes_ += cell_.change_scene().empty() ? 0 : 1;
      cell_.state().person = before;
      scene_s_ = now_s + random.uniform(20, 90);
    }
  }
  int changes() const { return changes_; }

 private:
  /// Somebody stops within arm's reach of the sensor.
  void stand_close() {
    auto walk = cell_.walk_across(cell_.random().uniform(0.2, 0.4));
    walk.from_m = {0.5 * (walk.from_m[0] + walk.to_m[0]), 0.5 * (walk.from_m[1] + walk.to_m[1])};
    walk.speed_m_s = 0;
    cell_.company().send(0, walk);
  }

  RunningCell& cell_;
  double people_s_ = 8, part_s_ = 6, scene_s_ = 15;
  bool carries_ = false;
  int changes_ = 0;
};

/// What one cell's watch showed.
struct Shown {
  std::map<std::string, double> seconds;  // by verdict
  double largest = 0, worst_check = 0, moved_s = 0;
  double robot_doubt = 0, creep_doubt = 0;  // of their limits
  double unseen_s = 0;                      // the pose could not be called good
  std::size_t frames = 0, alarms = 0, evidence = 0;

  json::object described(const WatchedSensor& sensor) const {
    json::object of;
    for (const auto& [name, duration] : seconds) of[name] = std::round(10 * duration) / 10;
    return {{"frames", frames},
            {"with_evidence", evidence},
            {"false_alarms", alarms},
            {"first_alarm_s", moved_s},
            {"largest", largest},
            {"threshold", sensor.watch().report().threshold},
            {"checks", sensor.checks()},
            {"worst_check_sigmas", worst_check},
            {"unseen_s", unseen_s},
            {"robot_doubt", robot_doubt},
            {"creep_doubt", creep_doubt},
            {"ms_median", quantile(sensor.frame_ms(), 0.5)},
            {"ms_99", quantile(sensor.frame_ms(), 0.99)},
            {"ms_most", quantile(sensor.frame_ms(), 1)},
            {"seconds", of}};
  }
};

json::object watch_cell(const CalibratedScenes::One& one,
                        const std::shared_ptr<const sim::SensorTables>& tables, std::uint64_t seed,
                        double seconds, InnovationWriter& innovations) {
  RunningCell cell(one.scene, tables, seed);
  WorkingCell work(cell);
  WatchedSensor sensor(one.scene, one.calibration, {});
  Shown shown;
  while (cell.time_s() < seconds) {
    work.happen();
    const auto frame = cell.next();
    const auto verdict = sensor.see(frame);
    ++shown.frames;
    shown.seconds[name_of(verdict)] += 1 / RunningCell::kRate_hz;
    shown.largest = std::max(shown.largest, sensor.watch().report().statistic);
    shown.worst_check = std::max(shown.worst_check, sensor.last_check().shift_sigmas);
    if (sensor.watch().is_out_of_sight() || sensor.watch().is_contested())
      shown.unseen_s += 1 / RunningCell::kRate_hz;
    shown.robot_doubt = std::max(shown.robot_doubt, sensor.watch().robot_word().doubt());
    shown.creep_doubt = std::max(shown.creep_doubt, sensor.watch().robot_word().creep_doubt());
    if (const auto& innovation = sensor.watch().innovation()) {
      innovations.write(static_cast<std::uint32_t>(seed), frame.view.stamp_s, *innovation);
      ++shown.evidence;
    }
    if (verdict != DriftVerdict::sensor_moved) continue;
    ++shown.alarms;
    if (shown.moved_s == 0) shown.moved_s = cell.time_s();
    sensor.learn_again(one.scene.views);
  }
  json::object line = shown.described(sensor);
  line["seed"] = seed;
  line["robot"] = one.scene.robot->name;
  line["scene_changes"] = work.changes();
  return line;
}

}  // namespace

int run_watch_hours(const WatchHoursOptions& options) {
  auto robots = read_scene_robots(options);
  if (!robots) return stop(robots.error().message());
  const CalibratedScenes scenes(*std::move(robots));
  InnovationWriter innovations(options.innovations);
  if (!innovations.is_open()) return stop("cannot write " + options.innovations.string());
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 1);
  std::uint64_t cells = 0;
  for (std::uint64_t seed = options.first_seed; cells < options.cells; ++seed) {
    const auto one = scenes.get(seed, true);
    if (!one) continue;
    ++cells;
    const double seconds = 3600 * options.hours / static_cast<double>(options.cells);
    const auto line = watch_cell(*one, scenes.tables(), seed, seconds, innovations);
    std::printf("%s\n", json::serialize(line).c_str());
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace calibrd::bench
