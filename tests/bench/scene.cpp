// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/scene.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "core/calibration/model_views.hpp"
#include "core/virtual_cell/virtual_cell.hpp"
#include "drivers/sim/model/robot_file.hpp"

namespace calibrd::bench {
namespace {

constexpr double kOtherLinksWeight = 0.02;
constexpr int kStride = 4;

/// A point of the robot as the sensor sees it and as the reported joints place it.
struct PointPair {
  Eigen::Vector3d p_sensor, p_base;
  int link;
};

void add_pairs(const Scene& scene, std::size_t view, VirtualCell& cell, VirtualMeasurement& seen,
               std::vector<PointPair>& pairs) {
  const Pose& T_base_sensor = scene.truth.T_base_sensor;
  const auto T_base_reported = scene.robot->model.forward_kinematics(scene.views[view].joint_positions_rad);
  cell.set_joints(scene.true_joints_rad(view));
  cell.measure(scene.camera, T_base_sensor, seen);
  for (int y = 0; y < seen.height; y += kStride)
    for (int x = 0; x < seen.width; x += kStride) {
      const auto i = static_cast<std::size_t>(y * seen.width + x);
      if (seen.link[i] < 0) continue;
      const auto link = static_cast<std::size_t>(seen.link[i]);
      const Eigen::Vector3d p_sensor = seen.depth_m[i] * scene.camera.ray(x, y);
      const Eigen::Vector3d p_link = cell.link_poses()[link].inverse() * (T_base_sensor * p_sensor);
      pairs.push_back({p_sensor, T_base_reported[link] * p_link, seen.link[i]});
    }
}

/// The rigid transform with the least weighted squares (Kabsch).
Pose fit_rigid(const std::vector<PointPair>& pairs, const std::vector<double>& weights) {
  Eigen::Vector3d middle_sensor = Eigen::Vector3d::Zero(), middle_base = middle_sensor;
  double sum = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    middle_sensor += weights[i] * pairs[i].p_sensor;
    middle_base += weights[i] * pairs[i].p_base;
    sum += weights[i];
  }
  middle_sensor /= sum;
  middle_base /= sum;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i)
    spread += weights[i] * (pairs[i].p_base - middle_base) * (pairs[i].p_sensor - middle_sensor).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(spread, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  Pose T_base_sensor = Pose::Identity();
  T_base_sensor.linear() =
      svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
  T_base_sensor.translation() = middle_base - T_base_sensor.linear() * middle_sensor;
  return T_base_sensor;
}

}  // namespace

Result<SceneRobot> read_scene_robot(const std::filesystem::path& urdf, const Paths& models) {
  auto simulated = sim::read_robot(urdf, {models, ""});
  if (!simulated) return simulated.error();
  auto model = RobotModel::load(urdf, {models, ""});
  if (!model) return model.error();
  return SceneRobot{model->name(), std::move(*simulated), std::move(*model)};
}

Result<std::vector<SceneRobot>> read_scene_robots(const RandomScenes& scenes) {
  std::vector<SceneRobot> robots;
  for (const auto& urdf : scenes.urdfs) {
    auto robot = read_scene_robot(urdf, scenes.models);
    if (!robot) return robot.error();
    robots.push_back(*std::move(robot));
  }
  return robots;
}

std::vector<double> Scene::true_joints_rad(std::size_t view) const {
  std::vector<double> joints = views[view].joint_positions_rad;
  for (std::size_t j = 0; j < joints.size(); ++j) joints[j] += joint_zeros_rad[j];
  return joints;
}

Result<Scene> simulate_scene(const SceneRobot& robot, std::uint64_t seed, const sim::CaptureOptions& options,
                             const std::shared_ptr<const sim::SensorTables>& tables) {
  auto simulated = sim::simulate_capture(robot.simulated, seed, options, tables);
  if (!simulated) return simulated.error();
  const sim::CameraParameters& c = simulated->camera;
  Scene scene;
  scene.robot = &robot;
  scene.camera = {c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.distortion};
  Capture capture;
  capture.joint_names = simulated->joint_names;
  for (auto& view : simulated->views) {
    capture.views.push_back({{c.width, c.height, 0.001, std::move(view.depth_mm)},
                             GreyImage{c.width, c.height, std::move(view.infrared)},
                             std::move(view.joint_positions_rad),
                             0});
    scene.robot_pixels.push_back(view.robot_pixels);
  }
  // The zeros take the way of the joints, as one view more.
  capture.views.push_back({{}, std::nullopt, simulated->joint_zero_rad, 0});
  auto views = views_in_model_order(robot.model, std::move(capture));
  if (!views) return views.error();
  scene.joint_zeros_rad = std::move(views->back().joint_positions_rad);
  views->pop_back();
  scene.views = std::move(*views);
  simulated->views.clear();
  scene.truth = std::move(*simulated);
  return scene;
}

Pose pose_for_reported_joints(const Scene& scene, std::size_t views) {
  if (std::ranges::all_of(scene.joint_zeros_rad, [](double zero) { return zero == 0; }))
    return scene.truth.T_base_sensor;
  VirtualCell cell(scene.robot->model);
  VirtualMeasurement seen;
  std::vector<PointPair> pairs;
  for (std::size_t view = 0; view < views; ++view) add_pairs(scene, view, cell, seen, pairs);
  if (pairs.empty()) return scene.truth.T_base_sensor;
  const int tip = std::ranges::max(pairs, {}, &PointPair::link).link;
  std::vector<double> weights;
  for (const PointPair& pair : pairs) weights.push_back(pair.link == tip ? 1 : kOtherLinksWeight);
  return fit_rigid(pairs, weights);
}

double check_point_rms_m(const Scene& scene, const Pose& T_base_sensor) {
  double squares = 0;
  for (const auto& [p_sensor, p_base] : scene.truth.check_points)
    squares += (T_base_sensor * p_sensor - p_base).squaredNorm();
  return std::sqrt(squares / static_cast<double>(scene.truth.check_points.size()));
}

}  // namespace calibrd::bench
