// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <mutex>

#include "api/problem/api_error.hpp"
#include "api/service/cell_service.hpp"

namespace calibrd::api {

/// A cell whose answers a test sets: one sensor, "kinect2".
class FakeCell : public CellService {
 public:
  PoseReport pose_report;
  RobotReport robot_report;
  DriftReport drift_report;
  StorageReport storage_report;
  std::string capture_of_calibration;
  SensorReport sensor_report;
  Cloud cloud_report;
  SensorFrame frame_report;
  mutable SensorFrameRequest last_frame;
  std::function<Result<CalibrationReport>(const CalibrationRequest&)> on_start;
  std::function<Result<CaptureArchive>(const CaptureRequest&)> on_capture;
  CalibrationReport calibration_report;
  CalibrationReport other_calibration;  ///< where it has an id
  std::vector<WorkspacePoint> points;
  mutable HistoryQuery last_history;
  PostureSuggestion suggestion;
  mutable NextPostureRequest last_next_posture;
  std::string cancelled, activated;
  MotionRequest last_motion;
  std::function<Result<MotionReport>(const MotionRequest&)> on_motion;
  MotionReport motion_report;
  std::string stopped;
  ObstaclesReport obstacles_report;
  MergedCloud merged_report;
  mutable MergedCloudRequest last_merged;
  CellCalibrationRequest last_start_all;
  std::vector<CellCalibrations::Refused> refused_starts;

  FakeCell() {
    pose_report.sensor_id = sensor_report.id = "kinect2";
    pose_report.base_frame = robot_report.base_frame = "base_link";
    pose_report.sensor_frame = "kinect2_optical";
    sensor_report.health = "streaming";
    robot_report.link_state = "streaming";
    calibration_report.id = "c1";
    calibration_report.sensor_id = "kinect2";
    motion_report.id = "m1";
    motion_report.route = "tour";
    motion_report.postures = 3;
  }

  void make_calibrated() {
    CalibrationResult result;
    result.verdict = Verdict::accepted;
    result.T_base_sensor = Pose(Eigen::Translation3d(1, 2, 3));
    result.sigma_position_m = 0.001;
    pose_report.known =
        PoseReport::Known{"c1", std::chrono::system_clock::now() - std::chrono::seconds(90), result};
    pose_report.age = Seconds(90);
    pose_report.state = PoseState::calibrated;
    pose_report.valid = true;
    pose_report.passed_check_age = Seconds(0.5);
    pose_report.last_check = CheckReport{true, 0.97, 0.001, Seconds(0.5)};
  }

  /// While a server is asking.
  void set_valid(bool valid) {
    const std::lock_guard lock(mutex_);
    pose_report.valid = valid;
  }

  CellReport cell() const override {
    return {"0", Seconds(1), robot_report, {sensor_report}, storage_report};
  }
  std::vector<SensorReport> sensors() const override { return {sensor_report}; }
  Result<SensorReport> sensor(std::string_view id) const override { return of_sensor(id, sensor_report); }
  Result<DriftReport> drift(std::string_view id) const override { return of_sensor(id, drift_report); }
  Result<PoseReport> pose(std::string_view id) const override {
    const std::lock_guard lock(mutex_);
    return of_sensor(id, pose_report);
  }
  RobotReport robot() const override { return robot_report; }
  Result<CalibrationReport> start_calibration(const CalibrationRequest& request) override {
    if (request.sensor_id != "kinect2") return fail(ApiError::no_such_sensor, request.sensor_id);
    return on_start ? on_start(request) : Result<CalibrationReport>(calibration_report);
  }
  Result<CalibrationReport> calibration(std::string_view id) const override { return of_calibration(id); }
  Result<CalibrationReport> cancel_calibration(std::string_view id) override {
    cancelled = id;
    return of_calibration(id);
  }
  Result<CalibrationReport> activate_calibration(std::string_view id) override {
    activated = id;
    return of_calibration(id);
  }
  Result<CaptureArchive> calibration_capture(std::string_view id) const override {
    if (const auto found = of_calibration(id); !found) return found.error();
    if (capture_of_calibration.empty()) return fail(ApiError::capture_not_kept, std::string(id));
    return CaptureArchive{std::string(id) + ".tar", capture_of_calibration};
  }
  Result<std::vector<WorkspacePoint>> workspace(std::string_view id) const override {
    return of_sensor(id, points);
  }
  Result<HistoryPage> history(const HistoryQuery& query) const override {
    last_history = query;
    return of_sensor(query.sensor_id, HistoryPage{{calibration_report}, true});
  }
  Result<PostureSuggestion> next_posture(const NextPostureRequest& request) const override {
    last_next_posture = request;
    if (!pose_report.known) return fail(ApiError::no_pose, request.sensor_id);
    return of_sensor(request.sensor_id, suggestion);
  }
  Result<CaptureArchive> record_capture(const CaptureRequest& request) override {
    return on_capture ? on_capture(request) : Result<CaptureArchive>(CaptureArchive{"a.tar", "tar bytes"});
  }
  Result<Cloud> cloud(const CloudRequest& request) const override {
    return of_sensor(request.sensor_id, cloud_report);
  }
  Result<std::optional<SensorFrame>> sensor_frame(const SensorFrameRequest& request) const override {
    last_frame = request;
    if (request.newer_than && frame_report.stamp <= *request.newer_than) return std::optional<SensorFrame>();
    return of_sensor(request.sensor_id, std::optional(frame_report));
  }
  std::string robot_urdf() const override { return "<robot name=\"fake\"/>"; }
  Result<TriangleMesh> link_surface(std::string_view link) const override {
    if (link != "link_1") return fail(ApiError::no_such_link, std::string(link));
    return TriangleMesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  }
  Result<ObstaclesReport> obstacles(const std::string& sensor_id) const override {
    return sensor_id.empty() ? obstacles_report : of_sensor(sensor_id, obstacles_report);
  }
  std::vector<SensorPair> pairs_report;
  std::vector<SensorPair> cross_checks() const override { return pairs_report; }
  Result<MergedCloud> merged_cloud(const MergedCloudRequest& request) const override {
    last_merged = request;
    if (merged_report.parts.empty()) return fail(ApiError::pose_not_valid);
    return merged_report;
  }
  Result<CellCalibrations> start_calibrations(const CellCalibrationRequest& request) override {
    last_start_all = request;
    return CellCalibrations{{calibration_report}, refused_starts};
  }

  Result<MotionReport> start_motion(const MotionRequest& request) override {
    last_motion = request;
    return on_motion ? on_motion(request) : Result<MotionReport>(motion_report);
  }
  MotionsReport motions() const override { return {true, "it moves", {"tour"}, {motion_report}}; }
  Result<MotionReport> motion(std::string_view id) const override { return of_motion(id); }
  Result<MotionReport> stop_motion(std::string_view id) override {
    stopped = id;
    return of_motion(id);
  }

 private:
  mutable std::mutex mutex_;  // guards pose_report while a server runs
  template <class T>
  Result<T> of_sensor(std::string_view id, T value) const {
    if (id != "kinect2") return fail(ApiError::no_such_sensor, std::string(id));
    return value;
  }
  Result<MotionReport> of_motion(std::string_view id) const {
    if (id != "m1") return fail(ApiError::no_such_motion, std::string(id));
    return motion_report;
  }
  Result<CalibrationReport> of_calibration(std::string_view id) const {
    if (!other_calibration.id.empty() && id == other_calibration.id) return other_calibration;
    if (id != "c1") return fail(ApiError::no_such_calibration, std::string(id));
    return calibration_report;
  }
};

}  // namespace calibrd::api
