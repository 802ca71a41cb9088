// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <boost/json.hpp>
#include <cstdio>
#include <ctime>

#include "core/cross_check/fuse_poses.hpp"
#include "core/obstacles/find_obstacles.hpp"
#include "drivers/sim/render/sensor_model.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/scene.hpp"

namespace calibrd::bench {
namespace {

namespace json = boost::json;

constexpr double kDegree = 0.017453292519943295;
constexpr double kWrong_m = 0.02, kWrong_rad = 0.02;
/// By how much the second sensor's focal length is configured too long, to see who notices.
constexpr std::array kWrongFocal{1.02, 1.03};

/// One sensor of a pair, calibrated from its own views.
struct Calibrated {
  Pose truth_T_base_sensor;
  std::vector<View> views;
  CalibrationResult result;
  std::unique_ptr<BackgroundMap> background;

  CheckedSensor checked(const Pose& T_base_sensor) const {
    return {*background, T_base_sensor, result.covariance, result.depth_correction};
  }
  CheckedSensor checked() const { return checked(*result.T_base_sensor); }
};

/// The same cell in the same postures, seen by a second sensor from 40° to 110° to the side.
Calibrated second_of(const Scene& scene, const std::shared_ptr<const sim::SensorTables>& tables,
                     std::uint64_t seed) {
  sim::Random random(seed ^ 0x5ec0dULL);
  const auto& world = *scene.truth.world;
  sim::WorldState state = world.state;
  auto& sensor = state.sensors[0];
  const double turn = (random.chance(0.5) ? 1 : -1) * random.uniform(40, 110) * kDegree;
  Calibrated second;
  second.truth_T_base_sensor =
      Pose(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ())) * scene.truth.T_base_sensor;
  sensor.T_base_sensor = sim::PoseValues::of(second.truth_T_base_sensor);
  sensor.depth.offset_m += 0.004 * random.normal();
  sensor.depth.wiggle_phase_rad += random.uniform(0, 6);
  sim::SensorModel model(world.cell, tables);
  for (std::size_t v = 0; v < scene.truth.postures.size(); ++v) {
    View view = scene.views[v];  // joints as reported
    state.motion.place(scene.truth.postures[v], 0);
    std::vector<std::uint16_t> infrared(view.depth.raw.size());
    model.expose(state, sensor, 0, seed * 7919 + v, view.depth.raw, infrared);
    if (view.image) view.image->pixels = infrared;
    second.views.push_back(std::move(view));
  }
  return second;
}

/// As if it had the intrinsics `camera`.
bool calibrate_it(const Scene& scene, const CameraModel& camera, Calibrated& sensor) {
  const VirtualCell cell(scene.robot->model);
  sensor.result = calibrate(cell, camera, sensor.views, {});
  if (sensor.result.verdict != Verdict::accepted) return false;
  RobotMask mask(cell, camera);
  std::vector<std::vector<std::uint8_t>> masks;
  for (const View& view : sensor.views)
    masks.push_back(mask.at(view.joint_positions_rad, *sensor.result.T_base_sensor));
  sensor.background = std::make_unique<BackgroundMap>(camera);
  sensor.background->learn(sensor.views, masks);
  return true;
}

struct Errors {
  double position_m, rotation_rad;
};
Errors error_of(const Pose& truth, const Pose& found) {
  const Vector6d delta = difference(truth, found);
  return {delta.tail<3>().norm(), delta.head<3>().norm()};
}

struct Totals {
  std::vector<double> single_m, fused_m, single_rad, fused_rad, sigmas, wrong_sigmas, obstacles_ms;
  int pairs = 0, without_overlap = 0, disagree = 0, wrong_found = 0;
  int focal_accepted = 0, focal_found = 0;  ///< poses of wrong focal lengths: by their own views, by the pair
};

/// The median processor time of looking for obstacles in a frame.
double obstacles_ms(const Scene& scene, const Calibrated& sensor) {
  const VirtualCell cell(scene.robot->model);
  ObstacleFinder finder(cell, scene.camera);
  std::vector<double> times;
  for (const View& view : sensor.views) {
    const auto begin = std::clock();
    finder.find(view, *sensor.background, *sensor.result.T_base_sensor, sensor.result.depth_correction);
    times.push_back(1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return median(times);
}

/// Sigmas apart, for each wrong focal length that the second's own views accept.
json::array with_wrong_focal(const Scene& scene, const Calibrated& first, Calibrated& second,
                             Totals& totals) {
  json::array sigmas;
  for (const double wrong : kWrongFocal) {
    CameraModel camera = scene.camera;
    camera.fx *= wrong;
    camera.fy *= wrong;
    Calibrated off{second.truth_T_base_sensor, second.views, {}, nullptr};
    if (!calibrate_it(scene, camera, off)) continue;
    const CrossCheck check = cross_check(first.checked(), off.checked());
    ++totals.focal_accepted;
    totals.focal_found += check.disagrees();
    sigmas.push_back(std::isfinite(check.sigmas) ? json::value(check.sigmas) : json::value("inf"));
  }
  return sigmas;
}

void run_pair(const Scene& scene, const Calibrated& first, Calibrated& second, std::uint64_t seed,
              Totals& totals) {
  ++totals.pairs;
  const CrossCheck check = cross_check(first.checked(), second.checked());
  totals.obstacles_ms.push_back(obstacles_ms(scene, first));
  if (!check.has_overlap) {
    ++totals.without_overlap;
    return;
  }
  std::mt19937_64 random(seed);
  const CrossCheck wrong = cross_check(
      first.checked(), second.checked(off_by(*second.result.T_base_sensor, kWrong_m, kWrong_rad, random)));
  const FusedPoses fused = fuse_poses(first.checked(), second.checked(), check);
  for (const auto& [sensor, pose] :
       {std::pair{&first, fused.first_T_base_sensor}, {&second, fused.second_T_base_sensor}}) {
    const Errors single = error_of(sensor->truth_T_base_sensor, *sensor->result.T_base_sensor),
                 joint = error_of(sensor->truth_T_base_sensor, pose);
    totals.single_m.push_back(single.position_m);
    totals.fused_m.push_back(joint.position_m);
    totals.single_rad.push_back(single.rotation_rad);
    totals.fused_rad.push_back(joint.rotation_rad);
  }
  totals.sigmas.push_back(check.sigmas);
  totals.wrong_sigmas.push_back(wrong.sigmas);
  totals.disagree += check.disagrees();
  totals.wrong_found += wrong.disagrees();
  const json::object line{
      {"seed", seed},
      {"pairs", check.pairs},
      {"sigmas", check.sigmas},
      {"shift_mm", 1e3 * check.shift_m},
      {"turn_mrad", 1e3 * check.turn_rad},
      {"sigmas_of_wrong_focal", with_wrong_focal(scene, first, second, totals)},
      {"sigmas_of_wrong", std::isfinite(wrong.sigmas) ? json::value(wrong.sigmas) : json::value("inf")}};
  std::printf("%s\n", json::serialize(line).c_str());
  std::fflush(stdout);
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::ranges::max_element(values);
}

void print_totals(const Totals& totals) {
  std::printf(
      "{\"pairs\": %d, \"without_overlap\": %d, \"disagree\": %d, \"sigmas_median\": %s, \"sigmas_max\": %s, "
      "\"wrong_found\": %d, \"focal_accepted\": %d, \"focal_found\": %d, \"single_mm\": %s, \"fused_mm\": "
      "%s, \"single_mrad\": %s, \"fused_mrad\": %s, "
      "\"obstacles_ms\": %s}\n",
      totals.pairs, totals.without_overlap, totals.disagree, shown(median(totals.sigmas), 2).c_str(),
      shown(largest(totals.sigmas), 2).c_str(), totals.wrong_found, totals.focal_accepted, totals.focal_found,
      shown(1e3 * median(totals.single_m), 3).c_str(), shown(1e3 * median(totals.fused_m), 3).c_str(),
      shown(1e3 * median(totals.single_rad), 3).c_str(), shown(1e3 * median(totals.fused_rad), 3).c_str(),
      shown(median(totals.obstacles_ms), 2).c_str());
}

}  // namespace

int run_pairs(const PairsOptions& options) {
  const auto robots = read_scene_robots(options);
  if (!robots) return stop(robots.error().message());
  sim::CaptureOptions capture;
  capture.postures = options.postures;
  const auto tables = std::make_shared<const sim::SensorTables>(sim::SensorState{}.camera);
  Totals totals;
  for (std::uint64_t i = 0; i < options.scenes; ++i) {
    const std::uint64_t seed = options.first_seed + i;
    auto scene = simulate_scene((*robots)[i % robots->size()], seed, capture, tables);
    if (!scene) continue;
    Calibrated first{scene->truth.T_base_sensor, scene->views, {}, nullptr};
    Calibrated second = second_of(*scene, tables, seed);
    if (calibrate_it(*scene, scene->camera, first) && calibrate_it(*scene, scene->camera, second))
      run_pair(*scene, first, second, seed, totals);
  }
  print_totals(totals);
  return totals.pairs > 0 ? 0 : 1;
}

}  // namespace calibrd::bench
