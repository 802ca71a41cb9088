// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/scenes/simulate_capture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/sim/model/postures.hpp"
#include "drivers/sim/world/sim_error.hpp"

namespace calibrd::sim {
namespace {

constexpr double kRadians = std::numbers::pi / 180;
constexpr int kPostureTries = 20000, kPoseTries = 100;
constexpr std::size_t kCheckPoints = 30;
constexpr std::size_t kTrialViews = 2;  // enough to turn down most places of the sensor
constexpr std::int64_t kViewStep_ns = 3'000'000'000;
constexpr double kSeen_m = 0.004;

/// The work on one recording: what the steps below share.
struct Recording {
  FurnishedCell furnished;
  std::vector<Joints> postures;  // true
  Random random;

  const Cell& cell() const { return furnished.cell; }
  SensorState& sensor() { return furnished.state.sensors[0]; }
  std::int64_t time_ns(std::size_t view) const { return static_cast<std::int64_t>(view + 1) * kViewStep_ns; }
};

Status find_postures(Recording& recording, std::size_t count) {
  const WorldState& state = recording.furnished.state;
  const Clearance clearance(recording.cell(),
                            {state.objects.data(), static_cast<std::size_t>(state.object_count)});
  for (int i = 0; i < kPostureTries && recording.postures.size() < count; ++i) {
    const Joints q = random_posture(recording.cell().robot, recording.random);
    if (clearance.is_free(q)) recording.postures.push_back(q);
  }
  if (recording.postures.size() < count)
    return sim_error(SimError::no_free_posture, recording.cell().robot.name);
  return Done{};
}

/// Middle of the links' frames over all postures: what the sensor looks at.
Eigen::Vector3d middle_of_robot(const Recording& recording) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0;
  for (const Joints& posture : recording.postures)
    for (const auto& pose : recording.cell().robot.link_poses(posture)) {
      sum += pose.translation();
      ++count;
    }
  return sum / count;
}

/// Somewhere around the robot, looking at it, turned about the line of sight.
Eigen::Isometry3d random_pose(const Eigen::Vector3d& middle, const CaptureOptions& options, Random& random) {
  const double azimuth = random.uniform(-std::numbers::pi, std::numbers::pi),
               elevation = random.uniform(5, 50) * kRadians;
  const double distance = random.uniform(options.min_distance_m, options.max_distance_m);
  const Eigen::Vector3d out(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                            std::sin(elevation));
  const Eigen::Vector3d position = middle + distance * out;
  const Eigen::Vector3d aim =
      middle + Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)) * 0.12;
  const Eigen::Vector3d z = (aim - position).normalized(), x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << x, z.cross(x), z;
  pose.linear() *=
      Eigen::AngleAxisd(random.uniform(-1, 1) * options.max_roll_deg * kRadians, Eigen::Vector3d::UnitZ())
          .matrix();
  pose.translation() = position;
  return pose;
}

SimulatedView take_view(Recording& recording, std::size_t index, std::uint64_t seed, SensorModel& model) {
  WorldState& state = recording.furnished.state;
  const Joints& posture = recording.postures[index];
  state.motion.place(posture, 0);
  SimulatedView view;
  const auto pixels = model.truth().depth_m.size();
  view.depth_mm.resize(pixels);
  view.infrared.resize(pixels);
  model.expose(state, state.sensors[0], recording.time_ns(index), seed * 1000 + index, view.depth_mm,
               view.infrared);
  view.robot_pixels = model.robot_pixels();
  const Joints reported = state.reported_at(recording.time_ns(index));
  view.joint_positions_rad.assign(reported.begin(), reported.begin() + state.joint_count);
  return view;
}

std::size_t mean_pixels(const std::vector<SimulatedView>& views) {
  std::size_t sum = 0;
  for (const auto& view : views) sum += view.robot_pixels;
  return views.empty() ? 0 : sum / views.size();
}

/// Points of the last link's surface that this view sees.
void add_check_points(const Recording& recording, std::size_t index, const SensorTables& tables,
                      const SensorModel& model, Random& random, std::vector<CheckPoint>& points) {
  const Robot& robot = recording.cell().robot;
  const auto last = std::find_if(robot.links.rbegin(), robot.links.rend(),
                                 [](const RobotLink& link) { return !link.mesh.vertices.empty(); });
  const auto link = static_cast<std::size_t>(robot.links.rend() - last) - 1;
  const WorldState& state = recording.furnished.state;
  const Eigen::Isometry3d T_base_true = robot.link_poses(recording.postures[index])[link];
  const Eigen::Isometry3d T_base_reported =
      robot.link_poses(state.reported_at(recording.time_ns(index)))[link];
  const Eigen::Isometry3d T_sensor_base = state.sensors[0].T_base_sensor.pose().inverse();
  const CameraParameters& camera = tables.grid.camera.parameters();
  constexpr std::size_t kTries = 400;
  for (std::size_t i = 0; i < kTries && points.size() < kCheckPoints; ++i) {
    const Eigen::Vector3d p_link =
        last->mesh.vertices[random.bits() % last->mesh.vertices.size()].cast<double>();
    const Eigen::Vector3d p_sensor = T_sensor_base * T_base_true * p_link;
    if (p_sensor.z() <= 0) continue;
    const Eigen::Vector2d pixel = tables.grid.camera.pixel(p_sensor.head<2>() / p_sensor.z());
    const auto x = std::lround(pixel.x()), y = std::lround(pixel.y());
    if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) continue;
    const auto at = static_cast<std::size_t>(y * camera.width + x);
    if (model.truth().robot[at] == 0 || std::abs(model.truth().depth_m[at] - p_sensor.z()) > kSeen_m)
      continue;
    points.push_back({p_sensor, T_base_reported * p_link});
  }
}

/// Some of each view, as evenly as they allow.
std::vector<CheckPoint> dealt(const std::vector<std::vector<CheckPoint>>& candidates) {
  std::vector<CheckPoint> points;
  for (std::size_t round = 0; round < kCheckPoints; ++round)
    for (const auto& view : candidates)
      if (round < view.size() && points.size() < kCheckPoints) points.push_back(view[round]);
  return points;
}

/// All views from one place of the sensor; nothing when too little of the robot is seen from there.
bool record_from_here(Recording& recording, const CaptureOptions& options, const SensorTables& tables,
                      SensorModel& model, SimulatedCapture& capture) {
  capture.views.clear();
  Random choice(capture.seed ^ 0x5eed);
  std::vector<std::vector<CheckPoint>> candidates;
  for (std::size_t i = 0; i < options.postures; ++i) {
    capture.views.push_back(take_view(recording, i, capture.seed, model));
    if (i + 1 == kTrialViews && mean_pixels(capture.views) < options.min_robot_pixels / 2) return false;
    add_check_points(recording, i, tables, model, choice, candidates.emplace_back());
  }
  capture.check_points = dealt(candidates);
  return mean_pixels(capture.views) >= options.min_robot_pixels && !capture.check_points.empty();
}

}  // namespace

Result<SimulatedCapture> simulate_capture(const Robot& robot, std::uint64_t seed,
                                          const CaptureOptions& options,
                                          const std::shared_ptr<const SensorTables>& tables) {
  Random random(seed);
  Recording recording{furnish(robot, options.level, tables->grid.camera.parameters(), random), {}, random};
  if (auto found = find_postures(recording, options.postures); !found) return found.error();
  const WorldState& state = recording.furnished.state;
  SimulatedCapture capture;
  capture.seed = seed;
  capture.level = options.level;
  for (const auto& range : robot.positions) capture.joint_names.push_back(range.name);
  capture.base_link = robot.links[static_cast<std::size_t>(robot.base_link)].name;
  capture.camera = tables->grid.camera.parameters();
  capture.depth_errors = state.sensors[0].depth;
  capture.joint_zero_rad.assign(state.joint_zero_rad.begin(),
                                state.joint_zero_rad.begin() + state.joint_count);
  SensorModel model(recording.cell(), tables);
  const Eigen::Vector3d middle = middle_of_robot(recording);
  for (int i = 0; i < kPoseTries; ++i) {
    capture.T_base_sensor = random_pose(middle, options, recording.random);
    recording.sensor().T_base_sensor = PoseValues::of(capture.T_base_sensor);
    if (!record_from_here(recording, options, *tables, model, capture)) continue;
    capture.world = std::make_shared<const FurnishedCell>(recording.furnished);
    capture.postures = recording.postures;
    return capture;
  }
  return sim_error(SimError::no_view_of_robot, "seed " + std::to_string(seed));
}

}  // namespace calibrd::sim
