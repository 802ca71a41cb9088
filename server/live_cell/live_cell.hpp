// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "api/service/cell_service.hpp"
#include "server/live_cell/calibration_jobs.hpp"
#include "server/live_cell/cloud_maker.hpp"
#include "server/live_cell/cloud_merger.hpp"
#include "server/live_cell/frame_maker.hpp"
#include "server/live_cell/healer.hpp"
#include "server/live_cell/live_robot.hpp"
#include "server/live_cell/live_sensor.hpp"
#include "server/live_cell/obstacle_watch.hpp"
#include "server/live_cell/robot_motions.hpp"
#include "server/live_cell/sensor_comparison.hpp"
#include "server/storage/calibration_store.hpp"
#include "server/storage/capture_folder.hpp"

namespace calibrd {

/// What the estimator gives the cell; core's calibrate() and check_pose(), unless a test puts others there.
struct Estimator {
  CalibrateFunction calibrate;
  std::function<CheckFunction(const CameraModel&)> make_check;  ///< one for each sensor
  /// One for each sensor; unset: poses are checked against the robot alone.
  std::function<std::unique_ptr<DriftWatch>(const CameraModel&, double rate_hz)> make_watch = {};
  /// One for each sensor that wants it; unset: time offsets are not estimated.
  std::function<std::unique_ptr<TimeOffsetEstimator>(const CameraModel&)> make_time_offset = {};
};

struct LiveCellSettings {
  std::string version;
  std::filesystem::path urdf;
  std::vector<std::filesystem::path> search_paths;
  std::string base_link;                            ///< as configured; empty: the URDF's root
  std::optional<ControllerFrame> controller_frame;  ///< nothing: not configured
  Clock::duration joint_latency{0};  ///< from the joints' moment to the arrival of their message
  ViewGateSettings gate;             ///< but for the latency, which is each sensor's
  PoseWatchSettings watch;
  JobSettings jobs;
  HealerSettings healing;
  RobotMotionSettings motion;
  std::string configuration = {};                     ///< in effect, as TOML: kept with every calibration
  std::shared_ptr<CaptureFolder> captures = nullptr;  ///< for the views of calibrations; null: none are kept
};

/// Who hears of what happens in the cell; called on the threads it happens on.
struct CellLog {
  std::function<void(const api::CalibrationReport&)> on_calibration;  ///< see CalibrationJobs::Log
  std::function<void(const api::PoseReport&)> on_pose;  ///< every change of a pose, its state or validity
  std::function<void(const std::string&)> on_error;     ///< what went wrong and was asked for by nobody
  RobotMotions::Log on_motion = [](const auto&, bool) {};
  std::function<void(const api::CalibrationReport&)> on_start = {};  ///< of a calibration that was asked for
};

struct SensorSetup {
  std::string id;
  CameraModel camera;
  Clock::duration latency{0};
  std::optional<Pose> guess_T_base_sensor;
  std::vector<WorkspacePoint> workspace = {};  ///< where its calibrations tell their predicted error
  bool mirror = false;                         ///< its rows are flipped before anybody sees them
  bool estimates_time_offset = true;
  double rate_hz = 30;  ///< at which it delivers frames
};

/// The cell: robot, sensors, their poses and calibrations, behind the port of the HTTP interface.
/// add_sensor() and start() from one thread, before anything else; the rest from any.
class LiveCell : public api::CellService {
 public:
  /// `model` and `store` must outlive it; `virtual_cell` is copied.
  LiveCell(LiveCellSettings settings, const RobotModel& model, const VirtualCell& virtual_cell,
           JointMapping mapping, CalibrationStore& store, Estimator estimator, CellLog log);
  ~LiveCell() override;

  /// Of the sensors' threads, by id.
  std::map<std::string, const Heartbeat*> heartbeats() const;

  LiveRobot& robot_link() { return robot_; }
  RobotMotions& robot_motions() { return motions_; }

  /// Restores the sensor's stored pose, where it can be read.
  Status add_sensor(const SensorSetup& setup);
  /// Begins to read frames.
  void start(const std::string& sensor_id, std::unique_ptr<DepthSource> source);

  /// Makes everything under way let go; nothing waits any longer than it takes to look up.
  void request_stop();

  api::CellReport cell() const override;
  std::vector<api::SensorReport> sensors() const override;
  Result<api::SensorReport> sensor(std::string_view id) const override;
  Result<api::PoseReport> pose(std::string_view sensor_id) const override;
  Result<api::DriftReport> drift(std::string_view sensor_id) const override;
  api::RobotReport robot() const override { return robot_.report(); }
  Result<api::CalibrationReport> start_calibration(const api::CalibrationRequest& request) override;
  Result<api::CalibrationReport> calibration(std::string_view id) const override;
  Result<api::CalibrationReport> cancel_calibration(std::string_view id) override;
  Result<api::CalibrationReport> activate_calibration(std::string_view id) override;
  Result<api::HistoryPage> history(const api::HistoryQuery& query) const override;
  Result<std::vector<WorkspacePoint>> workspace(std::string_view sensor_id) const override;
  Result<PostureSuggestion> next_posture(const api::NextPostureRequest& request) const override;
  Result<api::CaptureArchive> calibration_capture(std::string_view id) const override;
  Result<api::CaptureArchive> record_capture(const api::CaptureRequest& request) override;
  Result<api::Cloud> cloud(const api::CloudRequest& request) const override;
  Result<std::optional<api::SensorFrame>> sensor_frame(const api::SensorFrameRequest& request) const override;
  std::string robot_urdf() const override { return robot_urdf_; }
  Result<TriangleMesh> link_surface(std::string_view link) const override;
  Result<api::MotionReport> start_motion(const api::MotionRequest& request) override {
    return motions_.start(request);
  }
  api::MotionsReport motions() const override { return motions_.list(); }
  Result<api::MotionReport> motion(std::string_view id) const override { return motions_.find(id); }
  Result<api::MotionReport> stop_motion(std::string_view id) override { return motions_.stop(id); }
  Result<api::ObstaclesReport> obstacles(const std::string& sensor_id) const override;
  std::vector<api::SensorPair> cross_checks() const override;
  Result<api::MergedCloud> merged_cloud(const api::MergedCloudRequest& request) const override;
  Result<api::CellCalibrations> start_calibrations(const api::CellCalibrationRequest& request) override;

 private:
  struct Entry {
    SensorSetup setup;
    std::unique_ptr<LiveSensor> sensor;
    std::mutex recording;  ///< guards recording_task
    std::shared_ptr<CollectTask> recording_task;
  };

  Result<Entry*> find(std::string_view sensor_id) const;
  std::optional<Pose> guess_for(const Entry& entry, const api::CalibrationRequest& request) const;
  bool publish(const api::CalibrationReport& calibration, const PoseOrigin& origin,
               std::shared_ptr<const BackgroundMap> background);
  void restore(const CurrentCalibration& stored, const LiveSensor& sensor);
  void hear_of_pose(const api::PoseReport& pose);
  void store_drift(const std::string& sensor_id, const std::string& calibration_id);
  void withhold(const Objection& objection);
  std::unique_ptr<DriftMonitor> make_monitor(const SensorSetup& setup);
  void adopt(const api::CalibrationReport& calibration, Clock::time_point seen_at,
             const Surroundings& surroundings);
  std::shared_ptr<const BackgroundMap> stored_background(const api::CalibrationReport& calibration);
  Surroundings review(LiveSensor& sensor, std::span<const View> views, CalibrationResult& result);
  void reject_if_moved(const CameraModel& camera, std::span<const View> views,
                       CalibrationResult& result) const;
  Result<std::vector<View>> collect(Entry& entry, const api::CaptureRequest& request);
  EvidenceKeeper evidence_keeper();
  void keep_views(const api::CalibrationReport& calibration, const LiveSensor& sensor,
                  std::span<const View> views) const;
  Result<api::CaptureArchive> archive(const LiveSensor& sensor, std::span<const View> views,
                                      const std::string& note) const;
  api::SensorReport report_of(const Entry& entry) const;

  const LiveCellSettings settings_;
  const Clock::time_point began_ = Clock::now();
  CalibrationStore& store_;
  const Estimator estimator_;
  const CellLog log_;
  std::atomic<bool> is_stopping_{false};
  const std::string robot_basis_;
  const std::string robot_urdf_;  // as it was when the model was loaded
  LiveRobot robot_;
  mutable RobotMotions motions_;    // hears of every posture that is suggested
  const VirtualCell virtual_cell_;  // copied by who places the robot
  mutable CloudMaker clouds_;
  mutable FrameMaker frames_;
  mutable CloudMerger cloud_merger_;
  mutable ObstacleWatch obstacle_watch_;
  std::map<std::string, std::unique_ptr<Entry>, std::less<>> entries_;  // fixed once started
  std::mutex publishing_;  // what is served last is what the store calls current
  CalibrationJobs jobs_;   // its thread uses the others
  Healer healer_;          // last: its thread uses jobs_
};

/// core's estimator for this robot. The returned functions refer to `cell`.
Estimator core_estimator(const VirtualCell& cell, const DriftSettings& drift);

}  // namespace calibrd
