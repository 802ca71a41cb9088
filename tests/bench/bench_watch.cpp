// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <tbb/global_control.h>

#include <boost/json.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>

#include "core/calibration/calibrate.hpp"
#include "core/calibration/check_pose.hpp"
#include "core/drift/drift_watch.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/running_cell.hpp"

namespace calibrd::bench {
namespace {

namespace json = boost::json;

constexpr double kQuiet_s = 4, kWatched_s = 9, kCheckPeriod_s = 0.2;
constexpr double kLeastVerdict_s = 0.3;

/// A sensor that was calibrated as in the field, and is watched from then on.
class WatchedSensor {
 public:
  WatchedSensor(const Scene& scene, const CalibrationResult& calibration, const DriftSettings& settings)
      : cell_(scene.robot->model),
        watch_(cell_, scene.camera, settings),
        checker_(cell_, scene.camera),
        T_base_sensor_(*calibration.T_base_sensor),
        correction_(calibration.depth_correction) {
    watch_.set_pose(T_base_sensor_);
    watch_.learn(scene.views);
  }

  void see(const RunningCell::Frame& frame) {
    const auto begin = std::chrono::steady_clock::now();
    watch_.add_frame(frame.view);
    const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - begin;
    spent_ms_ += spent.count();
    ++frames_;
    const double now_s = frame.view.stamp_s;
    if (now_s - checked_s_ < kCheckPeriod_s) return;
    checked_s_ = now_s;
    DepthCorrection correction = correction_;
    correction.offset_m += watch_.report().depth_offset_change_m;
    watch_.add_check(checker_.check(frame.view, T_base_sensor_, correction), now_s);
  }
  const DriftWatch& watch() const { return watch_; }
  double mean_ms() const { return spent_ms_ / frames_; }

 private:
  VirtualCell cell_;
  DriftWatch watch_;
  PoseChecker checker_;
  Pose T_base_sensor_;
  DepthCorrection correction_;
  double checked_s_ = -1, spent_ms_ = 0;
  int frames_ = 0;
};

/// What was shown for longest besides "in place".
std::string shown_most(const std::map<std::string, double>& seconds) {
  std::string most = "in_place";
  double longest = kLeastVerdict_s;
  for (const auto& [name, duration] : seconds)
    if (name != "in_place" && duration >= longest) {
      most = name;
      longest = duration;
    }
  return seconds.contains("sensor_moved") ? "sensor_moved" : most;
}

json::object run_event(const Scene& scene, const CalibrationResult& calibration,
                       const std::shared_ptr<const sim::SensorTables>& tables, Event event,
                       std::uint64_t seed) {
  RunningCell cell(scene, tables, seed);
  cell.send_person_away();
  WatchedSensor sensor(scene, calibration, {});
  std::map<std::string, double> before, after;
  while (cell.time_s() < kQuiet_s) {
    sensor.see(cell.next());
    before[name_of(sensor.watch().report().verdict)] += 1 / RunningCell::kRate_hz;
  }
  const std::string what = cell.stage(event);
  if (what.empty()) return {};
  int frames = 0, detected = -1;
  while (cell.time_s() < kQuiet_s + kWatched_s) {
    sensor.see(cell.next());
    ++frames;
    const auto verdict = sensor.watch().report().verdict;
    after[name_of(verdict)] += 1 / RunningCell::kRate_hz;
    if (detected < 0 && std::string(name_of(verdict)) == right_verdict(event)) detected = frames;
  }
  const auto& report = sensor.watch().report();
  json::object line{{"seed", seed},
                    {"event", right_verdict(event)},
                    {"what", what},
                    {"verdict", shown_most(after)},
                    {"before", shown_most(before)},
                    {"frames_to_verdict", detected},
                    {"statistic", report.statistic},
                    {"shift_mm", 1e3 * report.shift_m},
                    {"turn_mrad", 1e3 * report.turn_rad},
                    {"sigma_mm", 1e3 * report.shift_sigma_m},
                    {"sigma_mrad", 1e3 * report.turn_sigma_rad},
                    {"offset_mm", 1e3 * report.depth_offset_change_m},
                    {"same", report.same},
                    {"planes", sensor.watch().background().planes()},
                    {"ms", sensor.mean_ms()}};
  json::object seconds;
  for (const auto& [name, duration] : after) seconds[name] = std::round(10 * duration) / 10;
  line["seconds"] = seconds;
  return line;
}

}  // namespace

int run_watch(const WatchOptions& options) {
  std::vector<SceneRobot> robots;
  for (const auto& urdf : options.urdfs) {
    auto robot = read_scene_robot(urdf, options.models);
    if (!robot) {
      std::fprintf(stderr, "calibrd-bench: %s\n", robot.error().message().c_str());
      return 2;
    }
    robots.push_back(*std::move(robot));
  }
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 1);
  const auto tables = std::make_shared<const sim::SensorTables>(sim::CameraParameters{});
  for (std::uint64_t i = 0; i < options.events; ++i) {
    const std::uint64_t seed = options.first_seed + i;
    sim::CaptureOptions capture;
    capture.postures = 6;
    const auto scene = simulate_scene(robots[seed % robots.size()], seed, capture, tables);
    if (!scene || scene->truth.world->state.person.present != 0)
      continue;  // else the background holds a person
    const auto calibration =
        calibrate(scene->robot->model, scene->camera, scene->views, CalibrationSettings{});
    if (calibration.verdict != Verdict::accepted) continue;
    const auto line = run_event(*scene, calibration, tables, kEvents[seed % std::size(kEvents)], seed);
    if (line.empty()) continue;
    std::printf("%s\n", json::serialize(line).c_str());
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace calibrd::bench
