// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/calibration/check_pose.hpp"
#include "core/drift/drift_watch.hpp"
#include "tests/bench/running_cell.hpp"

namespace calibrd::bench {

/// A sensor that was calibrated as in the field, and is watched from then on, as the daemon does it: every
/// frame against the background; against the robot while it stands still, every second, and ten times a
/// second while the watch asks for it.
class WatchedSensor {
 public:
  WatchedSensor(const Scene& scene, const CalibrationResult& calibration, const DriftSettings& settings);

  /// Returns the verdict.
  DriftVerdict see(const RunningCell::Frame& frame);
  const DriftWatch& watch() const { return watch_; }
  /// After a false alarm: as if it had been calibrated anew.
  void learn_again(std::span<const View> views);
  /// CPU time of each frame's watching, checks not counted, ms.
  const std::vector<double>& frame_ms() const { return frame_ms_; }
  int checks() const { return checks_; }
  const PoseCheck& last_check() const { return last_check_; }

 private:
  VirtualCell cell_;
  DriftWatch watch_;
  PoseChecker checker_;
  Pose T_base_sensor_;
  Matrix6d covariance_;
  DepthCorrection correction_;
  double checked_s_ = -1e9;
  PoseCheck last_check_;
  int checks_ = 0;
  std::vector<double> frame_ms_;
};

/// Scenes of those robots, one after the other, with their calibrations: what the benchmarks of the watch
/// begin with.
class CalibratedScenes {
 public:
  /// Must outlive what get() returns.
  explicit CalibratedScenes(std::vector<SceneRobot> robots);

  struct One {
    Scene scene;
    CalibrationResult calibration;
  };
  /// Nothing when there is none of this seed: not simulated, a person in the picture from the start, not
  /// accepted.
  std::unique_ptr<One> get(std::uint64_t seed, bool without_other_robot = false) const;
  const std::shared_ptr<const sim::SensorTables>& tables() const { return tables_; }

 private:
  std::vector<SceneRobot> robots_;
  std::shared_ptr<const sim::SensorTables> tables_;
};

/// The smallest value that `share` of them do not exceed; 0 of none.
double quantile(std::vector<double> values, double share);

}  // namespace calibrd::bench
