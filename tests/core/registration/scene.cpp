// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/core/registration/scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/core/virtual_cell/urdf_text.hpp"

namespace calibrd::test {
namespace {

constexpr int kFine = 2;  // rays per pixel and direction that an image pixel averages over

std::string arm_links() {
  const std::string flange = box_shape({0.06, 0.09, 0.05}, shift(0.02, 0, 0.05));
  return link("base",
              cylinder_shape(0.12, 0.2, shift(0, 0, 0.1)) + box_shape({0.28, 0.2, 0.06}, shift(0, 0, 0.03))) +
         link("shoulder", box_shape({0.2, 0.16, 0.2}, shift(0, 0, 0.1))) +
         link("upper", box_shape({0.13, 0.11, 0.36}, shift(0.03, 0, 0.18))) +
         link("elbow", cylinder_shape(0.07, 0.18) + box_shape({0.1, 0.1, 0.14}, shift(0.02, 0.01, 0.08))) +
         link("fore", box_shape({0.09, 0.1, 0.26}, shift(0, 0.01, 0.16))) +
         link("wrist", box_shape({0.08, 0.12, 0.09}, shift(0, -0.01, 0.03))) + link("flange", flange);
}

std::string arm_joints() {
  return revolute("j1", "base", "shoulder", "0 0 1", shift(0, 0, 0.2)) +
         revolute("j2", "shoulder", "upper", "0 1 0", shift(0.05, 0, 0.15)) +
         revolute("j3", "upper", "elbow", "0 0 1", shift(0.03, 0, 0.4)) +
         revolute("j4", "elbow", "fore", "0 1 0", shift(0, 0, 0.12)) +
         revolute("j5", "fore", "wrist", "0 0 1", shift(0, 0, 0.3)) +
         revolute("j6", "wrist", "flange", "0 1 0", shift(0, 0, 0.06));
}

/// Standard deviation of a time-of-flight pixel (Fankhauser 2015), m.
double noise_m(double z, double cosine) {
  const double angle = std::acos(std::clamp(cosine, 0.1, 1.0)), rest = std::numbers::pi / 2 - angle;
  return 1e-3 * (1.5 - 0.5 * z + 0.3 * z * z + 0.1 * std::pow(z, 1.5) * angle * angle / (rest * rest));
}

double cosine_of(const VirtualMeasurement& m, std::size_t i, const CameraModel& camera, int x, int y) {
  return -m.normal[i].cast<double>().dot(camera.ray(x, y).normalized());
}

/// The nearer of two measurements, pixel by pixel; links of `other` count as -1.
void add_behind(VirtualMeasurement& m, const VirtualMeasurement& other) {
  for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
    if (other.depth_m[i] <= 0 || (m.depth_m[i] > 0 && m.depth_m[i] < other.depth_m[i])) continue;
    m.depth_m[i] = other.depth_m[i];
    m.normal[i] = other.normal[i];
    m.link[i] = -1;
  }
}

VirtualMeasurement measured(const VirtualCell& cell, const CameraModel& camera, const Pose& T_base_sensor) {
  VirtualMeasurement m;
  cell.measure(camera, T_base_sensor, m);
  return m;
}

VirtualMeasurement truth(const std::vector<double>& joints, const CameraModel& camera,
                         const Pose& T_base_sensor, const SceneSettings& settings) {
  static const VirtualCell arm(test_arm()), cell(test_clutter());
  VirtualCell posed(arm);
  posed.set_joints(joints);
  VirtualMeasurement m = measured(posed, camera, T_base_sensor);
  if (settings.clutter) add_behind(m, measured(cell, camera, T_base_sensor));
  if (settings.second_arm) {
    posed.set_joints(std::vector{1.0, -0.3, 0.5, 0.9, 0.0, 0.4});
    const Pose T_base_second = shift(-0.3, -0.6, 0);
    add_behind(m, measured(posed, camera, T_base_second.inverse() * T_base_sensor));
  }
  return m;
}

DepthImage measure_depth(const VirtualMeasurement& m, const CameraModel& camera,
                         const SceneSettings& settings, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  DepthImage depth{m.width, m.height, 0.0001, std::vector<std::uint16_t>(m.depth_m.size(), 0)};
  for (int y = 0; y < m.height; ++y) {
    for (int x = 0; x < m.width; ++x) {
      const std::size_t i = depth.index(x, y);
      double z = m.depth_m[i];
      double cosine = z > 0 ? cosine_of(m, i, camera, x, y) : 1;
      if (x < settings.hidden_share * m.width) z = 0.6, cosine = 1;
      if (z <= 0 || cosine < 0.1) continue;  // no echo
      const double measured =
          settings.scale * z + settings.offset_m + settings.noise * noise_m(z, cosine) * normal(random);
      depth.raw[i] =
          static_cast<std::uint16_t>(std::clamp(std::lround(measured / depth.scale_m), 0L, 65535L));
    }
  }
  return depth;
}

CameraModel finer(const CameraModel& camera) {
  CameraModel fine = camera;
  fine.width *= kFine;
  fine.height *= kFine;
  fine.fx *= kFine;
  fine.fy *= kFine;
  fine.cx = (camera.cx + 0.5) * kFine - 0.5;
  fine.cy = (camera.cy + 0.5) * kFine - 0.5;
  return fine;
}

/// Grey value of one ray: light from beside the lens, weaker with distance; each link of another paint.
double brightness(const VirtualMeasurement& m, std::size_t i, const CameraModel& camera, int x, int y,
                  bool hidden) {
  if (hidden) return 900;
  if (m.depth_m[i] <= 0) return 150;
  const double paint = m.link[i] < 0 ? 700 : 1800 + 150 * (m.link[i] % 3);
  return paint * cosine_of(m, i, camera, x, y) / std::pow(m.depth_m[i], 2) + 100;
}

GreyImage photograph(const VirtualMeasurement& m, const CameraModel& fine, const SceneSettings& settings,
                     std::mt19937_64& random) {
  std::normal_distribution<double> noise(0, 8);
  GreyImage image{m.width / kFine, m.height / kFine, {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      double sum = 0;
      for (int k = 0; k < kFine * kFine; ++k) {
        const int u = kFine * x + k % kFine, v = kFine * y + k / kFine;
        const std::size_t i =
            static_cast<std::size_t>(v) * static_cast<std::size_t>(m.width) + static_cast<std::size_t>(u);
        sum += brightness(m, i, fine, u, v, u < settings.hidden_share * m.width);
      }
      const double value = sum / (kFine * kFine) + noise(random);
      image.pixels.push_back(static_cast<std::uint16_t>(std::clamp(value, 0.0, 65535.0)));
    }
  }
  return image;
}

}  // namespace

const RobotModel& test_arm() {
  static const RobotModel robot = robot_from(arm_links() + arm_joints());
  return robot;
}

const RobotModel& test_clutter() {
  static const RobotModel cell =
      robot_from(link("cell", box_shape({1.6, 1.2, 0.05}, shift(0.2, 0, -0.025)) +
                                  box_shape({0.3, 0.2, 0.15}, shift(0.5, 0.35, 0.075)) +
                                  box_shape({0.2, 0.25, 0.3}, shift(0.1, -0.45, 0.15)) +
                                  box_shape({0.08, 0.08, 1.5}, shift(-0.5, 0.5, 0.7)) +
                                  box_shape({0.05, 4, 3}, shift(-1.2, 0, 0.5))));
  return cell;
}

CameraModel ideal_kinect2() { return {512, 424, 365.456, 365.456, 254.878, 205.395, {0, 0, 0, 0, 0}}; }

CameraModel kinect2() {
  return {512, 424, 365.456, 365.456, 254.878, 205.395, {0.0905, -0.268, 0, 0, 0.0951}};
}

Pose true_T_base_sensor() {
  Pose T = looking_at({1.35, 0.6, 0.95}, {0.1, 0.0, 0.5});
  T.linear() = T.linear() * exp_so3({0.01, -0.02, 0.03});
  return T;
}

std::vector<std::vector<double>> postures(std::size_t count) {
  std::vector<std::vector<double>> all{{0.3, 0.4, 0.2, 1.0, 0.3, 0.6},    {-0.5, -0.2, 0.8, 1.3, -0.5, -0.4},
                                       {0.9, 0.6, -0.6, 0.7, 1.0, 0.9},   {-0.1, 0.1, 1.5, -1.1, 0.2, 0.3},
                                       {0.5, -0.4, -1.0, 1.5, -1.2, 0.2}, {-0.9, 0.5, 0.4, 0.5, 0.7, -0.8}};
  all.resize(count);
  return all;
}

View render_view(const std::vector<double>& joints, const Pose& T_base_sensor,
                 const SceneSettings& settings) {
  std::mt19937_64 random(settings.seed);
  const CameraModel& camera = settings.camera;
  View view;
  view.joint_positions_rad = joints;
  view.depth = measure_depth(truth(joints, camera, T_base_sensor, settings), camera, settings, random);
  if (settings.images) {
    const CameraModel fine = finer(camera);
    view.image = photograph(truth(joints, fine, T_base_sensor, settings), fine, settings, random);
  }
  return view;
}

std::vector<View> render_views(std::size_t count, const SceneSettings& settings) {
  std::vector<View> views;
  SceneSettings each = settings;
  for (const auto& joints : postures(count)) {
    views.push_back(render_view(joints, true_T_base_sensor(), each));
    each.seed += 1000;
  }
  return views;
}

Pose off_by(const Pose& T_base_sensor, double offset_m, double angle_rad, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
  };
  const Eigen::Vector3d axis = direction(), shift_direction = direction();
  return turned_about(T_base_sensor, {0, 0, 1.3}, angle_rad * axis, offset_m * shift_direction);
}

}  // namespace calibrd::test
