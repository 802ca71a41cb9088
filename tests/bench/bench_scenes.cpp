// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <boost/json.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <mutex>
#include <numbers>
#include <thread>

#include "core/calibration/calibrate.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/pose_bound.hpp"
#include "tests/bench/scene.hpp"

namespace calibrd::bench {
namespace {

namespace json = boost::json;

constexpr double kChiSquared6_95 = 12.592;  // 95 % of 6 degrees of freedom
constexpr const char* kLevels[] = {"clean", "cell", "field"};
constexpr double kDegrees = 180 / std::numbers::pi;

json::array scaled(const Eigen::Vector3d& v, double factor) {
  return {factor * v.x(), factor * v.y(), factor * v.z()};
}

/// What the seed says of the scene besides its contents.
struct Plan {
  const SceneRobot* robot;
  sim::CaptureOptions capture;
};

Plan plan_for(std::uint64_t seed, const std::vector<SceneRobot>& robots, const ScenesOptions& options) {
  Plan plan{&robots[seed % robots.size()], {}};
  plan.capture.postures = std::ranges::max(options.postures);
  const auto named = std::ranges::find(kLevels, options.level);
  // Mixed: the level changes once all robots have had their turn.
  const auto level = named != std::end(kLevels) ? static_cast<std::uint64_t>(named - std::begin(kLevels))
                                                : seed / robots.size() % std::size(kLevels);
  // Level clean is the robot and its noise alone.
  plan.capture.level = options.noise_only ? sim::Level::clean : static_cast<sim::Level>(level);
  return plan;
}

json::object describe(std::uint64_t seed, const Plan& plan, const ScenesOptions& options) {
  json::object line{{"seed", seed},
                    {"robot", plan.robot->name},
                    {"level", kLevels[static_cast<int>(plan.capture.level)]},
                    {"depth_only", options.depth_only},
                    {"jobs", options.jobs}};
  if (options.guess_mm || options.guess_deg) {
    line["guess_mm"] = options.guess_mm.value_or(0);
    line["guess_deg"] = options.guess_deg.value_or(0);
  }
  return line;
}

/// Where the sensor stands: from the base's origin, about the base's z axis, and turned about its line of
/// sight out of the upright.
void add_place(const Pose& T_base_sensor, json::object& line) {
  const Eigen::Vector3d p = T_base_sensor.translation(), x = T_base_sensor.linear().col(0),
                        z = T_base_sensor.linear().col(2);
  const Eigen::Vector3d level = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  line["distance_m"] = p.norm();
  line["azimuth_deg"] = kDegrees * std::atan2(p.y(), p.x());
  line["roll_deg"] = kDegrees * std::atan2(level.cross(x).dot(z), level.dot(x));
}

CalibrationResult calibrate_scene(const Scene& scene, std::size_t views, const ScenesOptions& options) {
  CalibrationSettings settings;
  settings.depth_only = options.depth_only;
  if (options.guess_mm || options.guess_deg) {
    std::mt19937_64 random(scene.truth.seed);
    settings.guess_T_base_sensor = off_by(scene.truth.T_base_sensor, 1e-3 * options.guess_mm.value_or(0),
                                          options.guess_deg.value_or(0) / kDegrees, random);
  }
  return calibrate(scene.robot->model, scene.camera, std::span(scene.views).first(views), settings);
}

void add_errors(const Scene& scene, std::size_t views, const CalibrationResult& result, json::object& line) {
  const Pose& estimate = *result.T_base_sensor;
  const Vector6d from_truth = difference(scene.truth.T_base_sensor, estimate);
  line["error_mm"] = 1e3 * from_truth.tail<3>().norm();
  line["error_mrad"] = 1e3 * from_truth.head<3>().norm();
  line["axes_mm"] = scaled(from_truth.tail<3>(), 1e3);
  line["axes_mrad"] = scaled(from_truth.head<3>(), 1e3);
  line["sensor_axes_mm"] = scaled(scene.truth.T_base_sensor.linear().transpose() * from_truth.tail<3>(), 1e3);
  line["check_points_mm"] = 1e3 * check_point_rms_m(scene, estimate);
  // The covariance speaks of the pose that is right for the joints as reported.
  const Vector6d delta = difference(estimate, pose_for_reported_joints(scene, views));
  const double nees = delta.dot(result.covariance.ldlt().solve(delta));
  line["as_reported_mm"] = 1e3 * delta.tail<3>().norm();
  line["as_reported_mrad"] = 1e3 * delta.head<3>().norm();
  line["nees"] = nees;
  line["inside95"] = nees <= kChiSquared6_95;
  line["sigma_position_mm"] = 1e3 * result.sigma_position_m;
  line["sigma_rotation_mrad"] = 1e3 * result.sigma_rotation_rad;
}

void add_bounds(const Scene& scene, std::size_t views, json::object& line) {
  const PoseBounds bounds = pose_bounds(scene, views);
  line["bound_known_mm"] = 1e3 * bounds.range_known.position_m;
  line["bound_known_mrad"] = 1e3 * bounds.range_known.rotation_rad;
  line["bound_free_mm"] = 1e3 * bounds.range_free.position_m;
  line["bound_free_mrad"] = 1e3 * bounds.range_free.rotation_rad;
  line["bound_pixels"] = bounds.pixels;
}

std::string judge_scene(const Scene& scene, std::size_t views, const ScenesOptions& options,
                        json::object line) {
  const CalibrationResult result = calibrate_scene(scene, views, options);
  std::size_t pixels = 0;
  for (std::size_t v = 0; v < views; ++v) pixels += scene.robot_pixels[v];
  json::array reasons;
  for (const Reason& reason : result.reasons) reasons.emplace_back(reason.code);
  line["K"] = views;
  line["robot_pixels"] = pixels / views;  // per view
  line["verdict"] = name_of(result.verdict);
  line["reasons"] = reasons;
  line["coverage"] = result.coverage;
  line["time_ms"] = result.time_total_ms;
  if (result.T_base_sensor) add_errors(scene, views, result, line);
  if (options.bound) add_bounds(scene, views, line);
  return json::serialize(line) + '\n';
}

/// The lines of one seed.
std::string run_scene(std::uint64_t seed, const std::vector<SceneRobot>& robots, const ScenesOptions& options,
                      const std::shared_ptr<const sim::SensorTables>& tables) {
  const Plan plan = plan_for(seed, robots, options);
  json::object line = describe(seed, plan, options);
  const auto begin = std::chrono::steady_clock::now();
  const auto scene = simulate_scene(*plan.robot, seed, plan.capture, tables);
  const auto end = std::chrono::steady_clock::now();
  line["simulate_ms"] = std::chrono::duration<double, std::milli>(end - begin).count();
  if (!scene) {
    line["error"] = scene.error().message();
    return json::serialize(line) + '\n';
  }
  add_place(scene->truth.T_base_sensor, line);
  std::string lines;
  for (const std::size_t views : options.postures) lines += judge_scene(*scene, views, options, line);
  return lines;
}

/// Puts out what several threads make, in the order of the seeds. Safe to call from any thread.
class OrderedOutput {
 public:
  void put(std::uint64_t index, std::string lines) {
    const std::scoped_lock lock(mutex_);
    waiting_[index] = std::move(lines);
    for (; waiting_.contains(next_); ++next_) {
      std::fputs(waiting_.extract(next_).mapped().c_str(), stdout);
      std::fflush(stdout);
    }
  }

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, std::string> waiting_;
  std::uint64_t next_ = 0;
};

}  // namespace

int run_scenes(ScenesOptions options) {
  // A count given twice would count its scenes twice.
  std::ranges::sort(options.postures, std::greater());
  const auto repeated = std::ranges::unique(options.postures);
  options.postures.erase(repeated.begin(), repeated.end());
  const auto robots = read_scene_robots(options);
  if (!robots) return stop(robots.error().message());
  const auto tables = std::make_shared<const sim::SensorTables>(sim::CameraParameters{});
  std::atomic<std::uint64_t> next = 0;
  OrderedOutput output;
  const auto work = [&] {
    for (std::uint64_t i = next++; i < options.scenes; i = next++)
      output.put(i, run_scene(options.first_seed + i, *robots, options, tables));
  };
  std::vector<std::jthread> workers;
  for (unsigned job = 1; job < options.jobs; ++job) workers.emplace_back(work);
  work();
  return 0;
}

}  // namespace calibrd::bench
