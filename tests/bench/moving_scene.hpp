// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "core/timing/link_motion.hpp"
#include "server/live_cell/joint_history.hpp"
#include "tests/bench/scene.hpp"

namespace calibrd::bench {

/// How the robot goes round the postures of a scene, and how late what it and the sensor say arrives.
struct MovingOptions {
  double speed_m_s = 0.25;         ///< of the robot's fastest point, between its ramps
  double acceleration_m_s2 = 1.0;  ///< of that point, at the postures, where it turns into another direction
  double joint_latency_s = 0.010, frame_latency_s = 0.040;
  double frame_jitter_s = 0.001;  ///< mean of what comes on top, exponential
};

/// A scene whose robot moves for ever from posture to posture, straight in joint space. Time in seconds.
class MovingScene {
 public:
  /// `scene` must outlive it.
  MovingScene(const Scene& scene, const sim::CaptureOptions& capture, const MovingOptions& options,
              const std::shared_ptr<const sim::SensorTables>& tables);

  double lap_s() const { return times_s_.back(); }
  /// In the middle between one posture and the next, once each lap.
  std::vector<double> middles_s() const;
  /// As reported, order of the model.
  std::vector<double> reported_joints(double time_s) const;

  /// Exposed at that time. Its stamp_s is that of its arrival.
  View expose(double time_s, std::uint64_t seed);
  /// What has arrived until `time_s`, and was reported since `begin_s`, every 25 ms.
  JointHistory joints(double begin_s, double time_s) const;
  static Clock::time_point clock_at(double time_s);

 private:
  std::vector<double> path_at(double time_s) const;

  const Scene& scene_;
  MovingOptions options_;
  sim::Random random_;
  sim::FurnishedCell furnished_;
  sim::SensorModel model_;
  std::vector<std::size_t> places_;        // in the model's vector, of the simulator's positions
  std::vector<std::vector<double>> path_;  // true joints, order of the model; finely divided
  std::vector<double> times_s_;            // when each point of it is passed
  std::vector<std::size_t> middles_;       // points of it
};

}  // namespace calibrd::bench
