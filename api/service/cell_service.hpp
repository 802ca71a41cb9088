// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/service/cell_reports.hpp"
#include "api/service/frame_reports.hpp"
#include "api/service/motion_reports.hpp"
#include "api/service/reports.hpp"
#include "core/base/result.hpp"
#include "core/robot/triangle_mesh.hpp"

namespace calibrd::api {

/// What the HTTP interface asks of the cell. Safe to call from any thread. Errors are ApiError unless said
/// otherwise.
///
/// Calls marked quick answer from memory and never wait for a calibration, a render, the disk or a device:
/// the server makes them on its only network thread.
class CellService {
 public:
  virtual ~CellService() = default;

  virtual CellReport cell() const = 0;                                      ///< quick
  virtual std::vector<SensorReport> sensors() const = 0;                    ///< quick
  virtual Result<SensorReport> sensor(std::string_view id) const = 0;       ///< quick
  virtual Result<PoseReport> pose(std::string_view sensor_id) const = 0;    ///< quick
  virtual Result<DriftReport> drift(std::string_view sensor_id) const = 0;  ///< quick
  virtual RobotReport robot() const = 0;                                    ///< quick
  /// The robot's model as it was loaded: its URDF. Quick.
  virtual std::string robot_urdf() const = 0;
  /// What of a link is seen, link frame, m; empty for a link without geometry.
  virtual Result<TriangleMesh> link_surface(std::string_view link) const = 0;

  /// Starts a calibration, or finds the one an equal request with the same Idempotency-Key started.
  virtual Result<CalibrationReport> start_calibration(const CalibrationRequest& request) = 0;
  virtual Result<CalibrationReport> calibration(std::string_view id) const = 0;
  virtual Result<CalibrationReport> cancel_calibration(std::string_view id) = 0;
  virtual Result<CalibrationReport> activate_calibration(std::string_view id) = 0;
  virtual Result<HistoryPage> history(const HistoryQuery& query) const = 0;

  /// The configured points where the sensor's pose must be good. Quick.
  virtual Result<std::vector<WorkspacePoint>> workspace(std::string_view sensor_id) const = 0;

  /// The views of a calibration, as a capture/1 folder in a tar archive, while they are kept.
  virtual Result<CaptureArchive> calibration_capture(std::string_view id) const = 0;

  /// Where to move the robot next so that a calibration knows the sensor's pose best.
  virtual Result<PostureSuggestion> next_posture(const NextPostureRequest& request) const = 0;

  /// Records postures of the live cell as a capture/1 folder, in a tar archive. Waits for the robot to hold
  /// still.
  virtual Result<CaptureArchive> record_capture(const CaptureRequest& request) = 0;
  virtual Result<Cloud> cloud(const CloudRequest& request) const = 0;
  /// Nothing: there is none newer than asked for.
  virtual Result<std::optional<SensorFrame>> sensor_frame(const SensorFrameRequest& request) const = 0;

  /// Moves the robot; only where the configuration allows it, and nothing speaks against it.
  virtual Result<MotionReport> start_motion(const MotionRequest& request) = 0;
  virtual MotionsReport motions() const = 0;                           ///< quick
  virtual Result<MotionReport> motion(std::string_view id) const = 0;  ///< quick
  virtual Result<MotionReport> stop_motion(std::string_view id) = 0;   ///< quick
  /// What is neither robot nor remembered background. `sensor_id` empty: for all sensors.
  virtual Result<ObstaclesReport> obstacles(const std::string& sensor_id) const = 0;
  /// Every pair of sensors, compared by what both see of the cell.
  virtual std::vector<SensorPair> cross_checks() const = 0;
  virtual Result<MergedCloud> merged_cloud(const MergedCloudRequest& request) const = 0;
  /// Starts a calibration of each sensor, so that one motion of the robot serves all. The error of the first
  /// when none could be started.
  virtual Result<CellCalibrations> start_calibrations(const CellCalibrationRequest& request) = 0;
};

}  // namespace calibrd::api
