// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Calibrations whose sensor is knocked between two of their views, and the same ones undisturbed.
#include <boost/json.hpp>
#include <cstdio>

#include "core/drift/moved_meanwhile.hpp"
#include "drivers/sim/render/sensor_model.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/scene.hpp"

namespace calibrd::bench {
namespace {

namespace json = boost::json;

struct Knock {
  std::size_t before = 0;  ///< the last view of before it
  Pose T_base_sensor = Pose::Identity();
  const char* kind = "";
};

/// By turns a slide, a turn about the sensor and both, each in any direction.
Knock knock_of(const Scene& scene, const KnockedOptions& options) {
  std::mt19937_64 random(scene.truth.seed * 7919 + 5);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
  };
  static constexpr std::array kKinds{"slide", "turn", "both"};
  const auto kind = (scene.truth.seed / 3) % kKinds.size();
  Vector6d delta = Vector6d::Zero();
  if (kind != 0) delta.head<3>() = 1e-3 * options.turn_mrad * direction();
  if (kind != 1) delta.tail<3>() = 1e-3 * options.shift_mm * direction();
  const auto before = std::uniform_int_distribution<std::size_t>(0, scene.views.size() - 2)(random);
  return {before, perturbed(scene.truth.T_base_sensor, delta), kKinds[kind]};
}

/// The scene's views, those after the knock taken from where it left the sensor.
std::vector<View> knocked_views(const Scene& scene, const Knock& knock,
                                const std::shared_ptr<const sim::SensorTables>& tables) {
  const auto& world = *scene.truth.world;
  sim::WorldState state = world.state;
  state.sensors[0].T_base_sensor = sim::PoseValues::of(knock.T_base_sensor);
  sim::SensorModel model(world.cell, tables);
  auto views = scene.views;
  for (std::size_t v = knock.before + 1; v < views.size(); ++v) {
    state.motion.place(scene.truth.postures[v], 0);
    std::vector<std::uint16_t> infrared(views[v].depth.raw.size());
    model.expose(state, state.sensors[0], 0, scene.truth.seed * 7919 + v, views[v].depth.raw, infrared);
    if (views[v].image) views[v].image->pixels = std::move(infrared);
  }
  return views;
}

/// `T_base_sensor`: where the sensor stands at the end.
json::object judge(const Scene& scene, std::span<const View> views, const Pose& T_base_sensor) {
  const CalibrationResult result = calibrate(scene.robot->model, scene.camera, views, {});
  json::object line{{"verdict", name_of(result.verdict)}};
  if (!result.T_base_sensor) return line;
  const Vector6d error = difference(T_base_sensor, *result.T_base_sensor);
  line["error_mm"] = 1e3 * error.tail<3>().norm();
  line["error_mrad"] = 1e3 * error.head<3>().norm();
  line["sigma_mm"] = 1e3 * result.sigma_position_m;
  ViewsInOrder order{VirtualCell(scene.robot->model), scene.camera};
  line["background_squares"] = order.background_split(views, *result.T_base_sensor).squares;
  line["robot_squares"] = order.robot_split(views, *result.T_base_sensor, result.depth_correction).squares;
  line["found"] = order.find_move(views, *result.T_base_sensor, result.depth_correction).has_value();
  return line;
}

json::object run_one(std::uint64_t seed, const SceneRobot& robot, const KnockedOptions& options,
                     const std::shared_ptr<const sim::SensorTables>& tables) {
  json::object line{{"seed", seed}, {"robot", robot.name}};
  sim::CaptureOptions capture;
  capture.postures = options.postures;
  capture.level = seed % 2 == 0 ? sim::Level::cell : sim::Level::field;
  const auto scene = simulate_scene(robot, seed, capture, tables);
  if (!scene) return line["error"] = scene.error().message(), line;
  const Knock knock = knock_of(*scene, options);
  line["kind"] = knock.kind;
  line["before"] = knock.before;
  line["still"] = judge(*scene, scene->views, scene->truth.T_base_sensor);
  line["knocked"] = judge(*scene, knocked_views(*scene, knock, tables), knock.T_base_sensor);
  return line;
}

}  // namespace

int run_knocked(const KnockedOptions& options) {
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
