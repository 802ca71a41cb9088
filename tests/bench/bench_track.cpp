// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <tbb/global_control.h>

#include <chrono>
#include <cstdio>
#include <numbers>

#include "bench.hpp"
#include "core/calibration/track.hpp"

namespace calibrd::bench {
namespace {

/// Sums over all updates.
struct Tally {
  std::vector<double> milliseconds;
  double squares_m2 = 0, squares_rad2 = 0, squares_at_robot_m2 = 0, nees = 0;
  std::size_t updates = 0, failures = 0;

  void add(const TrackedPose& tracked, const Pose& truth_T_base_sensor) {
    const Vector6d error = difference(truth_T_base_sensor, tracked.T_base_sensor);
    const Eigen::Vector3d ahead(0, 0, 1.3);
    squares_m2 += error.tail<3>().squaredNorm();
    squares_rad2 += error.head<3>().squaredNorm();
    squares_at_robot_m2 += (truth_T_base_sensor * ahead - tracked.T_base_sensor * ahead).squaredNorm();
    nees += error.dot(tracked.covariance.ldlt().solve(error));
    ++updates;
  }
  double mean(double sum) const { return sum / static_cast<double>(updates); }
  void print(std::size_t views) const {
    std::printf(
        "{\"median_ms\": %.3f, \"error_mm\": %.4f, \"error_mrad\": %.4f, \"views\": %zu, \"at_1300_mm\": "
        "%.4f, "
        "\"nees\": %.2f, \"updates\": %zu, \"failures\": %zu}\n",
        median(milliseconds), 1e3 * std::sqrt(mean(squares_m2)), 1e3 * std::sqrt(mean(squares_rad2)), views,
        1e3 * std::sqrt(mean(squares_at_robot_m2)), mean(nees), updates, failures);
  }
};

}  // namespace

int run_track(const TrackOptions& options) {
  const Input input = load(options.capture_dir, options.models);
  if (!input.truth_T_base_sensor)
    return stop(options.capture_dir.string() + " holds no truth.json to start around");
  // A watch knows the sensor's bias from the last calibration; so does this one.
  CalibrationSettings settings;
  settings.guess_T_base_sensor = input.truth_T_base_sensor;
  const CalibrationResult last = calibrate(input.robot, input.camera, input.views, settings);
  if (!last.T_base_sensor) return stop("the recording's own calibration was rejected; nothing to track with");

  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(options.threads));
  TrackSettings track;
  track.stride = options.stride;
  track.steps = options.steps;
  PoseTracker tracker(VirtualCell(input.robot), input.camera, track);
  std::mt19937_64 random(options.seed);
  Tally tally;
  for (int run = 0; run < options.runs; ++run) {
    for (const View& view : input.views) {
      const Pose start = off_by(*input.truth_T_base_sensor, 1e-3 * options.offset_mm,
                                options.offset_deg * std::numbers::pi / 180, random);
      const auto begin = std::chrono::steady_clock::now();
      const auto tracked = tracker.update(view, start, last.depth_correction);
      const auto end = std::chrono::steady_clock::now();
      tally.milliseconds.push_back(std::chrono::duration<double, std::milli>(end - begin).count());
      tracked ? tally.add(*tracked, *input.truth_T_base_sensor) : void(++tally.failures);
    }
  }
  if (tally.updates == 0) return stop("no view could be tracked");
  tally.print(input.views.size());
  return 0;
}

}  // namespace calibrd::bench
