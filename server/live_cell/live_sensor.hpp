// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "api/service/reports.hpp"
#include "core/base/heartbeat.hpp"
#include "core/calibration/check_pose.hpp"
#include "drivers/sensor/depth_source.hpp"
#include "server/live_cell/collect_task.hpp"
#include "server/live_cell/drift_monitor.hpp"
#include "server/live_cell/live_robot.hpp"
#include "server/live_cell/offset_watch.hpp"
#include "server/live_cell/pose_watch.hpp"
#include "server/live_cell/resting_place.hpp"
#include "server/live_cell/sighting.hpp"
#include "server/live_cell/view_gate.hpp"

namespace calibrd {

/// Compares a view with what a pose predicts. Called on the sensor's thread only.
using CheckFunction =
    std::function<PoseCheck(const View&, const Pose&, const DepthCorrection&, const Matrix6d& covariance)>;

/// What speaks for a pose, or against it, when it takes over.
struct PoseOrigin {
  std::optional<Clock::time_point> seen_at;  ///< of the views it was just found from; nothing: a stored pose
  bool drifted = false;                      ///< a stored one that had drifted
  bool moved_since = false;                  ///< the sensor may have moved since it was found
  std::string objection;                     ///< why a stored one must not be used, whatever checks say
};

/// A pose that was found, accepted or uncertain, and from which postures.
struct PoseEvidence {
  Pose T_base_sensor;
  Matrix6d covariance;                        ///< see perturbed()
  std::vector<std::vector<double>> postures;  ///< position_names() order; empty: not known any more
};

struct LiveSensorSettings {
  std::string id;
  std::string basis;  ///< what poses are found with now: see CurrentCalibration
  CameraModel camera;
  ViewGateSettings gate;
  PoseWatchSettings watch;
  std::vector<WorkspacePoint> workspace;
};

/// One sensor: a thread that reads its frames, decides which become views, feeds those who collect postures,
/// and keeps checking the current pose. Safe to call from any thread.
class LiveSensor {
 public:
  /// `robot` must outlive it.
  /// `monitor`: nothing, or what follows the pose frame by frame.
  /// `on_pose` hears, on the sensor's thread, of every change of the pose, its state or its validity.
  /// `time_offset`: null when the configured latencies are to be taken for true.
  LiveSensor(LiveSensorSettings settings, LiveRobot& robot, CheckFunction check,
             std::function<void(const api::PoseReport&)> on_pose = {},
             std::unique_ptr<DriftMonitor> monitor = {},
             std::unique_ptr<TimeOffsetEstimator> time_offset = {});
  ~LiveSensor();

  void start(std::unique_ptr<DepthSource> source);
  /// Returns at once; the thread, and with it the source, ends soon after.
  void request_stop() { is_stopping_ = true; }
  /// Waits for the thread to end.
  void join();

  const std::string& id() const { return settings_.id; }
  /// Of its thread.
  const Heartbeat& heartbeat() const { return heartbeat_; }
  const CameraModel& camera() const { return settings_.camera; }
  /// Where its calibrations tell their predicted error.
  const std::vector<WorkspacePoint>& workspace() const { return settings_.workspace; }

  const std::string& basis() const { return settings_.basis; }

  /// The pose being served. A stored one is unverified until a check agrees. `background`: of the pose.
  void set_pose(api::PoseReport::Known known, const PoseOrigin& origin,
                std::shared_ptr<const BackgroundMap> background = nullptr);

  /// Something else speaks against the pose being served: until another one takes over it is not valid,
  /// whatever its checks say. False: the pose being served is not that calibration's.
  bool withhold(const std::string& calibration_id, const std::string& objection);

  /// The pose being served, as a start for the next calibration: nothing while it is known to be wrong.
  std::optional<Pose> plausible_pose() const;

  /// What the newest calibration has found; counts until another pose takes over, or the sensor has drifted.
  /// `seen_at`: of the last view; what was seen before the sensor moved or was away is none.
  void set_evidence(PoseEvidence evidence, Clock::time_point seen_at);
  /// Without a calibration since the start: of the pose being served, unless it is known to be wrong.
  std::optional<PoseEvidence> evidence() const;

  /// Feeds the task with views until it is complete or cancelled.
  void feed(std::shared_ptr<CollectTask> task);

  /// The newest frame; nothing before the first.
  std::shared_ptr<const Sighting> newest() const;

  api::PoseReport pose() const;
  api::DriftReport drift() const;
  /// When it was last found to move, or was away: what was seen before is not known to hold now.
  Clock::time_point moved_at() const;
  /// Where a sensor that has moved is now, as far as its background tells.
  std::optional<Pose> seen_pose() const;
  /// See DriftMonitor.
  std::shared_ptr<const BackgroundMap> background() const {
    return monitor_ ? monitor_->background() : nullptr;
  }
  api::SensorReport report() const;
  /// Why it gives no views now, and what to do; empty: it does.
  std::string hindrance() const;

 private:
  void run();
  void take_up(DepthFrame frame);
  bool has_size_of_camera(const DepthFrame& frame) const;
  void settle();
  void finish(FrameDecision decision);
  void serve_tasks(const Sighting& sighting, bool usable);
  std::vector<std::shared_ptr<CollectTask>> open_tasks();
  void watch(const Sighting& sighting);
  void forget_evidence(bool was_plausible);
  void notice_move();
  bool is_check_due(Clock::time_point now) const;
  bool is_contested() const;
  void check(const Sighting& sighting);
  void note(FrameVerdict verdict);
  void notice_loss(const SensorHealth& health);
  bool is_blind(Clock::time_point now) const;
  PoseWatch worth_at(Clock::time_point now) const;
  void lose();
  void watch_offset();
  void tell_of_pose();
  double frame_rate_hz(Clock::time_point now) const;

  const LiveSensorSettings settings_;
  LiveRobot& robot_;
  const CheckFunction check_;
  const std::function<void(const api::PoseReport&)> on_pose_;
  std::atomic<bool> is_stopping_{false};
  Heartbeat heartbeat_;
  std::atomic<Clock::time_point> entered_at_{};  // when a frame last told something new

  const std::unique_ptr<DriftMonitor> monitor_;  // nothing: the pose is checked against the robot alone

  // The thread's own.
  RestingPlace resting_place_;
  std::uint64_t resting_number_ = 0;  // of the pose that it has moved from
  const std::shared_ptr<const LinkReach> reach_;
  OffsetWatch offset_;  // its report(): anybody's
  ViewGate gate_;
  std::deque<std::shared_ptr<Sighting>> pending_;  // entered, their joints not all there; oldest first
  std::uint64_t restarts_ = 0;                     // of the source, as far as noticed

  mutable std::mutex mutex_;  // guards what follows
  std::unique_ptr<DepthSource> source_;
  std::shared_ptr<const Sighting> newest_;
  std::deque<Clock::time_point> arrivals_;
  FrameVerdict verdict_ = FrameVerdict::no_joints;
  std::optional<double> timing_error_m_;  // of the newest judged frame
  std::array<std::uint64_t, kFrameVerdicts> counts_{};
  PoseWatch watch_;
  std::optional<api::PoseReport::Known> known_;
  Clock::time_point calibrated_at_;  // of known_, as the clock of the day had it when the pose took over
  std::optional<PoseEvidence> evidence_;
  Clock::time_point checked_at_;
  Clock::time_point moved_at_;     // when it was last found to have moved
  bool has_moved_ = false;         // by the monitor's last word
  Clock::time_point lost_at_;      // the last moment the source was away: frames before it prove nothing now
  std::uint64_t pose_number_ = 0;  // counts set_pose()
  struct Told {
    std::uint64_t pose_number = 0;
    api::PoseState state = api::PoseState::uncalibrated;
    bool valid = false;
    bool operator==(const Told&) const = default;
  };
  Told told_;  // what on_pose_ heard last
  std::vector<std::shared_ptr<CollectTask>> tasks_;

  std::thread thread_;
};

}  // namespace calibrd
