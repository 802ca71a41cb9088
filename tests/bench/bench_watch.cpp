// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <tbb/global_control.h>

#include <boost/json.hpp>
#include <cmath>
#include <cstdio>
#include <map>

#include "tests/bench/bench.hpp"
#include "tests/bench/watched_sensor.hpp"

namespace calibrd::bench {
namespace {

namespace json = boost::json;

/// From posture to posture the robot goes for some seven seconds.
constexpr double kQuiet_s = 2, kWatched_s = 12, kPostures_s = 60;
constexpr double kLeastVerdict_s = 0.3;

/// That the sensor has moved, if it was ever said; else what was said for longest besides "in place".
std::string told(const std::map<std::string, double>& seconds) {
  if (seconds.contains("sensor_moved")) return "sensor_moved";
  std::string most = "in_place";
  double longest = kLeastVerdict_s;
  for (const auto& [name, duration] : seconds)
    if (name != "in_place" && duration >= longest) {
      most = name;
      longest = duration;
    }
  return most;
}

json::object described(const WatchedSensor& sensor) {
  const auto& report = sensor.watch().report();
  return {{"statistic", report.statistic},
          {"shift_mm", 1e3 * report.shift_m},
          {"turn_mrad", 1e3 * report.turn_rad},
          {"sigma_mm", 1e3 * report.shift_sigma_m},
          {"sigma_mrad", 1e3 * report.turn_sigma_rad},
          {"offset_mm", 1e3 * report.depth_offset_change_m},
          {"same", report.same},
          {"planes", sensor.watch().background().planes()},
          {"ms_median", quantile(sensor.frame_ms(), 0.5)},
          {"ms_99", quantile(sensor.frame_ms(), 0.99)},
          {"checks", sensor.checks()},
          {"check_sigmas", sensor.last_check().shift_sigmas}};
}

json::object run_event(const CalibratedScenes::One& one,
                       const std::shared_ptr<const sim::SensorTables>& tables, Event event,
                       std::uint64_t seed) {
  RunningCell cell(one.scene, tables, seed * std::size(kEvents) + static_cast<std::uint64_t>(event));
  WatchedSensor sensor(one.scene, one.calibration, {});
  std::map<std::string, double> before, after;
  while (cell.time_s() < kQuiet_s) before[name_of(sensor.see(cell.next()))] += 1 / RunningCell::kRate_hz;
  const std::string what = cell.stage(event);
  if (what.empty()) return {};
  int frames = 0, detected = -1;
  // The robot must come to rest in two postures, and show the joint there, before one says that it is wrong.
  const double until_s = kQuiet_s + (event == Event::robot_model_wrong ? kPostures_s : kWatched_s);
  while (cell.time_s() < until_s) {
    const std::string verdict = name_of(sensor.see(cell.next()));
    ++frames;
    after[verdict] += 1 / RunningCell::kRate_hz;
    if (detected < 0 && verdict == right_verdict(event)) detected = frames;
  }
  json::object line{{"seed", seed},
                    {"robot", one.scene.robot->name},
                    {"event", right_verdict(event)},
                    {"what", what},
                    {"moved_mm", 1e3 * cell.moved_m()},
                    {"turned_mrad", 1e3 * cell.turned_rad()},
                    {"verdict", told(after)},
                    {"last", name_of(sensor.watch().report().verdict)},
                    {"before", told(before)},
                    {"frames_to_verdict", detected}};
  for (auto& [key, value] : described(sensor)) line[key] = value;
  json::object seconds;
  for (const auto& [name, duration] : after) seconds[name] = std::round(10 * duration) / 10;
  line["seconds"] = seconds;
  return line;
}

}  // namespace

int run_watch(const WatchOptions& options) {
  auto robots = read_scene_robots(options);
  if (!robots) return stop(robots.error().message());
  const CalibratedScenes scenes(*std::move(robots));
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 1);
  for (std::uint64_t seed = options.first_seed; seed < options.first_seed + options.scenes; ++seed) {
    const auto one = scenes.get(seed);
    if (!one) continue;
    for (const Event event : kEvents) {
      if (!options.event.empty() && options.event != right_verdict(event)) continue;
      const auto line = run_event(*one, scenes.tables(), event, seed);
      if (line.empty()) continue;
      std::printf("%s\n", json::serialize(line).c_str());
      std::fflush(stdout);
    }
  }
  return 0;
}

}  // namespace calibrd::bench
