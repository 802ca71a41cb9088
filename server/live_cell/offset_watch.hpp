// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <mutex>
#include <optional>

#include "api/service/reports.hpp"
#include "core/timing/time_offset_estimator.hpp"
#include "server/live_cell/live_robot.hpp"
#include "server/live_cell/sighting.hpp"
#include "server/live_cell/view_timing.hpp"

namespace calibrd {

struct OffsetWatchSettings {
  Clock::duration latency{0};                               ///< of the sensor, as configured
  Clock::duration period = std::chrono::milliseconds(150);  ///< between frames that are looked at
  double least_speed_m_s = 0.05;  ///< of the robot's fastest point: slower motion tells too little
  double apply_sigma_s = 0.003;   ///< the estimate counts from here ...
  double drop_sigma_s = 0.006;    ///< ... until it is this bad
};

/// The pose and range error that frames are compared with, and which of the sensor's poses it is.
struct OffsetBasis {
  Pose T_base_sensor;
  DepthCorrection correction;
  std::uint64_t pose_number = 0;
};

/// Keeps one sensor's time offset: now and then takes a frame of the moving robot, waits for the joints
/// around it, and gives both to the estimator. One thread; report() from any.
class OffsetWatch {
 public:
  /// `estimator` may be null: then nothing is estimated (sensors.ID.time_offset = "off").
  OffsetWatch(std::unique_ptr<TimeOffsetEstimator> estimator, std::shared_ptr<const LinkReach> reach,
              const OffsetWatchSettings& settings);

  /// A frame has come; it is kept when one is wanted.
  void offer(const std::shared_ptr<const Sighting>& sighting);
  /// Looks at the frame that is kept, once its joints are there. `basis`: nothing while no pose can be relied
  /// on. `link`: counts the robot's and the sensor's connections; another count begins anew.
  void work(const LiveRobot& robot, const std::optional<OffsetBasis>& basis, std::uint64_t link);

  /// Nothing: the configured latencies stand alone.
  std::optional<AppliedOffset> applied() const;
  api::TimeOffsetReport report(Clock::time_point now) const;

 private:
  bool follow(const std::optional<OffsetBasis>& basis, std::uint64_t link);
  bool is_moving(const JointHistory& joints, Clock::time_point stamp) const;
  void publish(Clock::time_point now);

  const std::unique_ptr<TimeOffsetEstimator> estimator_;
  const std::shared_ptr<const LinkReach> reach_;
  const OffsetWatchSettings settings_;
  std::shared_ptr<const Sighting> waiting_;
  Clock::time_point looked_at_;
  std::uint64_t link_ = 0, pose_number_ = 0;

  mutable std::mutex mutex_;  // guards what follows
  std::optional<TimeOffset> estimate_;
  std::optional<Clock::time_point> updated_at_;
  bool is_applied_ = false, has_basis_ = false;
};

}  // namespace calibrd
