// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Views of a moving robot, its time offset estimated, against views of the same postures standing still.
#include <boost/json.hpp>
#include <cstdio>

#include "core/calibration/calibrate.hpp"
#include "core/timing/time_offset_estimator.hpp"
#include "server/live_cell/view_timing.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/moving_scene.hpp"

namespace calibrd::bench {
namespace {

namespace json = boost::json;

constexpr double kFramePeriod_s = 0.15;  // as the daemon looks at frames for the offset

struct Estimated {
  std::optional<TimeOffset> offset;
  double learned_s = 0;
};

/// As the daemon does it: against the pose of a calibration from still views.
Estimated estimate_offset(MovingScene& moving, const Scene& scene, const CalibrationResult& still,
                          double seconds) {
  TimeOffsetEstimator estimator(VirtualCell(scene.robot->model), scene.camera);
  for (double t = 1; t < 1 + seconds; t += kFramePeriod_s) {
    const View frame = moving.expose(t, scene.truth.seed * 100'000 + static_cast<std::uint64_t>(1000 * t));
    const JointHistory joints = moving.joints(t - 0.5, t + 0.5);
    estimator.add(
        {frame.depth, MovingScene::clock_at(frame.stamp_s), *still.T_base_sensor, still.depth_correction},
        [&](Clock::time_point time) { return joints.positions_at(time); });
  }
  return {estimator.estimate(), seconds};
}

std::vector<View> still_views(MovingScene& moving, const Scene& scene) {
  std::vector<View> views;
  for (const double t : moving.middles_s()) {
    views.push_back(moving.expose(t, scene.truth.seed * 1000 + views.size()));
    views.back().joint_positions_rad = moving.reported_joints(t);
  }
  return views;
}

/// The same frames' moments, the joints as the stamps less `offset_s` have them. `largest_m`: of the timing
/// errors.
std::vector<View> moving_views(MovingScene& moving, const Scene& scene, double offset_s, double sigma_s,
                               double& largest_m) {
  const LinkReach reach(scene.robot->model);
  std::vector<View> views;
  for (const double t : moving.middles_s()) {
    views.push_back(moving.expose(t, scene.truth.seed * 1000 + 500 + views.size()));
    const JointHistory joints = moving.joints(t - 0.5, t + 0.5);
    const auto exposed = MovingScene::clock_at(views.back().stamp_s - offset_s);
    views.back().joint_positions_rad = joints.positions_at(exposed).value_or(moving.reported_joints(t));
    largest_m = std::max(largest_m, timing_error_m(joints, reach, exposed, sigma_s, 0).value_or(1));
  }
  return views;
}

void add_errors(const char* what, const CalibrationResult& result, const Pose& reference,
                json::object& line) {
  json::object errors{{"verdict", name_of(result.verdict)}};
  if (result.T_base_sensor) {
    const Vector6d error = difference(reference, *result.T_base_sensor);
    errors["mm"] = 1e3 * error.tail<3>().norm();
    errors["mrad"] = 1e3 * error.head<3>().norm();
    errors["sigma_mm"] = 1e3 * result.sigma_position_m;
  }
  line[what] = errors;
}

json::object run_one(std::uint64_t seed, const SceneRobot& robot, const MovingBenchOptions& options,
                     const std::shared_ptr<const sim::SensorTables>& tables) {
  json::object line{{"seed", seed}, {"robot", robot.name}, {"level", options.level}};
  sim::CaptureOptions capture;
  capture.postures = options.postures;
  capture.level = options.level == "clean"  ? sim::Level::clean
                  : options.level == "cell" ? sim::Level::cell
                                            : sim::Level::field;
  auto scene = simulate_scene(robot, seed, capture, tables);
  if (!scene) return line["error"] = scene.error().message(), line;
  MovingOptions motion;
  motion.speed_m_s = options.speed_m_s;
  motion.frame_latency_s = motion.joint_latency_s + 1e-3 * options.offset_ms;
  motion.frame_jitter_s = 1e-3 * options.jitter_ms;
  MovingScene moving(*scene, capture, motion, tables);
  scene->views = still_views(moving, *scene);
  const auto still = calibrate(robot.model, scene->camera, scene->views, {});
  const Pose reference = pose_for_reported_joints(*scene, scene->views.size());
  add_errors("still", still, reference, line);
  if (!still.T_base_sensor) return line;
  const double truth_s = 1e-3 * (options.offset_ms + options.jitter_ms);
  const auto estimated = estimate_offset(moving, *scene, still, options.learn_s);
  if (!estimated.offset) return line["error"] = "no offset", line;
  line["offset_error_ms"] = 1e3 * (estimated.offset->value_s - truth_s);
  line["offset_sigma_ms"] = 1e3 * estimated.offset->sigma_s;
  line["jitter_ms"] = 1e3 * estimated.offset->jitter_s;
  double largest_m = 0;
  const auto views =
      moving_views(moving, *scene, estimated.offset->value_s,
                   std::hypot(estimated.offset->sigma_s, estimated.offset->jitter_s), largest_m);
  line["timing_error_mm"] = 1e3 * largest_m;
  add_errors("moving", calibrate(robot.model, scene->camera, views, {}), reference, line);
  if (!options.also_uncorrected) return line;
  double ignored = 0;
  const auto uncorrected = moving_views(moving, *scene, 0, 0, ignored);
  add_errors("uncorrected", calibrate(robot.model, scene->camera, uncorrected, {}), reference, line);
  return line;
}

}  // namespace

int run_moving(const MovingBenchOptions& options) {
  const auto tables = std::make_shared<const sim::SensorTables>(sim::CameraParameters{});
  const auto robots = read_scene_robots(options);
  if (!robots) return stop(robots.error().message());
  for (std::uint64_t i = 0; i < options.scenes; ++i) {
    const std::uint64_t seed = options.first_seed + i;
    std::printf("%s\n",
                json::serialize(run_one(seed, (*robots)[seed % robots->size()], options, tables)).c_str());
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace calibrd::bench
