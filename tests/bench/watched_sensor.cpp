// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/watched_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

namespace calibrd::bench {
namespace {

constexpr double kCheckPeriod_s = 1, kDoubtPeriod_s = 0.1;
/// Of the calibration, and others that the robot's work takes it to afterwards.
constexpr std::size_t kPostures = 6, kOtherPostures = 8;

/// Of this thread, so that whoever else runs on the machine does not count.
double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace

WatchedSensor::WatchedSensor(const Scene& scene, const CalibrationResult& calibration,
                             const DriftSettings& settings)
    : cell_(scene.robot->model),
      watch_(cell_, scene.camera, settings),
      checker_(cell_, scene.camera),
      T_base_sensor_(*calibration.T_base_sensor),
      covariance_(calibration.covariance),
      correction_(calibration.depth_correction) {
  learn_again(scene.views);
}

void WatchedSensor::learn_again(std::span<const View> views) {
  watch_.set_pose(T_base_sensor_);
  watch_.learn(views);
}

DriftVerdict WatchedSensor::see(const RunningCell::Frame& frame) {
  const double begin_ms = cpu_ms();
  watch_.add_frame(frame.view);
  frame_ms_.push_back(cpu_ms() - begin_ms);
  const double now_s = frame.view.stamp_s, since_s = now_s - checked_s_;
  const bool due = since_s >= kCheckPeriod_s || (watch_.wants_check() && since_s >= kDoubtPeriod_s);
  if (!frame.still || frame.view.joint_positions_rad.empty() || !due) return watch_.report().verdict;
  checked_s_ = now_s;
  DepthCorrection correction = correction_;
  correction.offset_m += watch_.report().depth_offset_change_m;
  last_check_ = checker_.check(frame.view, T_base_sensor_, correction, covariance_);
  watch_.add_check(last_check_, frame.view.joint_positions_rad, now_s);
  ++checks_;
  return watch_.report().verdict;
}

CalibratedScenes::CalibratedScenes(std::vector<SceneRobot> robots)
    : robots_(std::move(robots)),
      tables_(std::make_shared<const sim::SensorTables>(sim::CameraParameters{})) {}

std::unique_ptr<CalibratedScenes::One> CalibratedScenes::get(std::uint64_t seed,
                                                             bool without_other_robot) const {
  sim::CaptureOptions capture;
  capture.postures = kPostures + kOtherPostures;
  auto scene = simulate_scene(robots_[seed % robots_.size()], seed, capture, tables_);
  if (!scene) return nullptr;
  scene->views.resize(kPostures);
  const auto& state = scene->truth.world->state;
  if (state.person.present != 0) return nullptr;  // else the background holds a person
  if (without_other_robot && state.other_robot.present != 0) return nullptr;
  auto calibration = calibrate(scene->robot->model, scene->camera, scene->views, CalibrationSettings{});
  if (calibration.verdict != Verdict::accepted) return nullptr;
  return std::make_unique<One>(One{*std::move(scene), std::move(calibration)});
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto rank =
      static_cast<std::size_t>(std::max(0.0, std::ceil(share * static_cast<double>(values.size())) - 1));
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(rank));
  return values[rank];
}

}  // namespace calibrd::bench
