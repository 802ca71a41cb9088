// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/calibration/calibrate.hpp"
#include "core/drift/drift_report.hpp"
#include "core/geometry/camera_model.hpp"
#include "core/geometry/pose.hpp"
#include "core/planning/next_posture.hpp"
#include "core/robot/controller_frame.hpp"
#include "core/sensing/images.hpp"

namespace calibrd::api {

using SystemTime = std::chrono::system_clock::time_point;
using Seconds = std::chrono::duration<double>;

enum class PoseState { uncalibrated, calibrated, unverified, drifted };

/// One comparison of a frame with what the current pose predicts.
struct CheckReport {
  bool agrees = false;
  double agreement = 0;          ///< share of measured robot pixels within tolerance, 0..1
  double median_residual_m = 0;  ///< measured minus predicted depth
  Seconds age{0};
};

/// The pose a sensor has, and whether it may be used.
struct PoseReport {
  struct Known {
    std::string calibration_id;
    SystemTime calibrated_at;
    CalibrationResult result;  ///< accepted, with T_base_sensor
  };
  std::string sensor_id;
  std::string base_frame;
  std::optional<ControllerFrame> controller_frame;  ///< nothing: not configured
  std::string sensor_frame;
  PoseState state = PoseState::uncalibrated;
  bool valid = false;     ///< state is calibrated and passed_check_age is below max_unverified
  std::string reason;     ///< why it is not valid, and what to do; empty while it is
  std::string job;        ///< id of a calibration under way; empty: none
  std::string candidate;  ///< id of one that was made after a move and waits to be activated; empty: none
  std::optional<Known> known;
  Seconds age{0};  ///< of `known`, since calibrated_at; does not follow a wall clock that is set meanwhile
  std::optional<CheckReport> last_check;    ///< agreeing or not
  std::optional<Seconds> passed_check_age;  ///< since the last check that agreed
  Seconds max_unverified{0};
};

/// The watch over a pose in one second.
struct DriftSample {
  Clock::time_point stamp;
  double statistic = 0;  ///< the largest
  double shift_m = 0, turn_rad = 0, depth_offset_change_m = 0;
};

/// The verdict became this.
struct DriftEvent {
  Clock::time_point stamp;
  std::string verdict;
};

/// What the watch over a sensor's pose says.
struct DriftReport {
  std::string sensor_id;
  PoseState pose_state = PoseState::uncalibrated;
  std::string healing;                ///< "automatic", "ask", "off"
  std::string candidate;              ///< id of a calibration that waits to be activated; empty: none
  std::optional<Seconds> healing_in;  ///< until the next attempt to calibrate it again; nothing: none is due
  bool watched = false;               ///< there is a pose to watch
  calibrd::DriftReport now;
  std::optional<Seconds> age;       ///< of the newest frame that was looked at
  std::vector<DriftSample> series;  ///< oldest first, the last ten minutes
  std::vector<DriftEvent> events;   ///< oldest first
};

/// What happened to the frames of a sensor on their way to becoming views.
struct ViewReport {
  bool usable = false;  ///< the newest judged frame became a view
  std::string code;     ///< "usable", "moving", "joints_stale", …
  std::string reason;   ///< in words, and what to do; empty while usable
  std::uint64_t views = 0;
  std::uint64_t moving_views = 0;  ///< of them of a moving robot
  /// How far (m) any point of the robot may be from where the joints put it in the newest judged frame (1
  /// sigma): 0 while it stands still, nothing where it is not known.
  std::optional<double> timing_error_m;
  std::vector<std::pair<std::string, std::uint64_t>> refused;  ///< code and number of frames, since start
};

/// How much later a sensor's frames are stamped than the robot's joints, beyond the configured latencies.
struct TimeOffsetReport {
  bool is_estimated = false;  ///< false: sensors.ID.time_offset is off
  bool applied = false;       ///< frames are paired with joints by it
  std::optional<Seconds> value, sigma;
  std::optional<Seconds> jitter;  ///< of single frames
  std::optional<Seconds> age;     ///< since it changed last
  std::string reason;             ///< why it is not applied, and what to do; empty while it is
};

struct SensorReport {
  std::string id;
  std::string health;  ///< "starting", "streaming", "lost"
  std::string reason;  ///< why it is not streaming, and what to do
  std::string device;  ///< vendor, name and URI of what is open
  std::string notice;  ///< what is not as configured although it streams
  std::uint64_t frames = 0, frames_lost = 0, restarts = 0;
  double frame_rate_hz = 0;
  std::optional<Seconds> frame_age;
  CameraModel camera;
  bool has_image = false;  ///< the newest frame came with an image
  ViewReport views;
  TimeOffsetReport time_offset;
  PoseState pose_state = PoseState::uncalibrated;
  bool pose_valid = false;
  std::string job;        ///< id of the calibration under way
  std::string ended_job;  ///< id of the one that has ended last, since the daemon began
};

struct LinkPlacement {
  std::string name;
  Pose T_base_link;
};

struct ControllerReport {
  std::optional<bool> drives_powered, e_stopped, in_error, in_motion, motion_possible;
  std::string mode;  ///< "unknown", "manual", "automatic"
  int error_code = 0;
  bool fresh = false;  ///< false: it is the last word of a controller that has fallen silent
  Seconds age{0};
};

struct RobotReport {
  std::string model;
  std::string base_frame;
  std::string controller_frame;  ///< empty: not configured
  std::string link_state;        ///< "connecting", "streaming", "joints_stale", "silent", "faulted"
  std::string link_reason;
  std::uint64_t connects = 0, framing_errors = 0, rejected_values = 0;
  std::vector<std::string> joint_names;
  std::optional<JointState> joints;  ///< newest; nothing before the first
  Seconds joints_age{0};
  bool joints_stale = true;
  bool joints_frozen = false;  ///< they repeat while the controller says that the robot moves
  bool still = false;
  std::optional<ControllerReport> controller;  ///< nothing before its first status
  std::vector<LinkPlacement> links;            ///< at `joints`; empty without them
};

/// Whether calibrations can be stored.
struct StorageReport {
  bool ready = true;
  /// "good", "recovered" (a damaged store was put aside), "unsaved" (its second copy of a pose is behind),
  /// "full", "read_only", "damaged", "failing"
  std::string state = "good";
  std::string reason;  ///< what is wrong, and what to do; empty while it is good
  bool operator==(const StorageReport&) const = default;
};

struct CellReport {
  std::string version;
  Seconds uptime{0};
  RobotReport robot;
  std::vector<SensorReport> sensors;
  StorageReport storage;
};

enum class JobStatus { queued, collecting, running, succeeded, failed, cancelled };

struct CalibrationRequest {
  std::string sensor_id;
  Method method = Method::full;
  std::optional<Pose> guess_T_base_sensor;  ///< nothing: as from_nothing says
  bool from_nothing = false;    ///< without a guess: true: start from none; false: from what the cell knows
  std::optional<int> postures;  ///< nothing: as configured
  bool activate = true;
  std::string idempotency_key;  ///< empty: none
  std::string fingerprint;      ///< equal for requests that ask for the same
  /// How long to wait for more than two postures; two and a half times as long for more than one. Nothing:
  /// until all have been seen.
  std::optional<Seconds> patience = {};
  bool after_move = false;  ///< the sensor has moved: start from where its background says it is
};

/// What a calibration was made from and with.
struct Evidence {
  struct View {
    double stamp_s = 0;  ///< monotonic clock of the daemon
    std::vector<double> joint_positions_rad;
  };
  std::string software_version;
  std::string configuration;  ///< in effect, as TOML
  std::vector<std::string> joint_names;
  std::vector<View> views;
};

/// A calibration, under way or ended. It succeeded exactly when its verdict is accepted.
struct CalibrationReport {
  std::string id;
  std::string sensor_id;
  JobStatus status = JobStatus::queued;
  double progress = 0;  ///< 0..1
  std::string message;  ///< what it is doing, or why it failed and what to do
  SystemTime created;
  std::optional<SystemTime> finished;
  Method method = Method::full;
  int postures_wanted = 0;
  int postures_seen = 0;
  bool activate = true;
  bool current = false;                     ///< its pose is the one being served
  std::optional<CalibrationResult> result;  ///< of every calibration that came to a verdict
  // Only where one calibration is asked for.
  std::optional<Evidence> evidence = {};            ///< of one that has ended
  std::optional<std::uint64_t> capture_bytes = {};  ///< size of its views, where they are kept
};

struct HistoryQuery {
  std::string sensor_id;
  int limit = 20;
  std::string before;  ///< id; empty: from the newest
};

struct HistoryPage {
  std::vector<CalibrationReport> calibrations;  ///< newest first
  bool more = false;
};

struct NextPostureRequest {
  std::string sensor_id;
  double table_height_m = 0;  ///< base frame; moving links stay above it
};

struct CaptureRequest {
  std::string sensor_id;
  int postures = 1;
  Seconds timeout{30};
  std::string note;
};

struct CaptureArchive {
  std::string file_name;  ///< "kinect2-20260102T030405Z.tar"
  std::string tar;
};

enum class CloudKind { measured, virtual_, residual };

struct CloudRequest {
  std::string sensor_id;
  CloudKind kind = CloudKind::measured;
  bool in_base_frame = false;
};

/// Points in `frame`, with the joints and the frame they were made from.
struct Cloud {
  std::string frame;
  std::vector<Eigen::Vector3f> points;         ///< m
  std::vector<float> residual_m;               ///< measured minus predicted depth; empty but for residual
  std::optional<std::int64_t> joint_stamp_ns;  ///< monotonic clock of the daemon
  std::vector<double> joint_positions_rad;
  std::optional<std::int64_t> frame_stamp_ns;  ///< monotonic clock of the daemon
  std::optional<Pose> T_base_sensor;           ///< the pose the points were made with
  bool pose_valid = false;  ///< T_base_sensor is a valid pose, not a guess or a last known one
};

}  // namespace calibrd::api
