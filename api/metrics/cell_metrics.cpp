// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/metrics/cell_metrics.hpp"

#include <array>

#include "api/routes/names.hpp"

namespace calibrd::api {
namespace {

constexpr std::array kLinkStates{"connecting", "streaming", "joints_stale", "silent", "faulted"};
constexpr std::array kHealths{"starting", "streaming", "lost"};
constexpr std::array kStorageStates{"good",      "recovered", "unsaved", "full",
                                    "read_only", "damaged",   "failing"};

/// One sensor at the moment of the scrape.
struct Snapshot {
  SensorReport sensor;
  PoseReport pose;
  DriftReport drift;
};

using Value = std::optional<double>;

struct SensorFigure {
  const char* family;
  Value (*value)(const Snapshot&);
};

template <class T>
double number(T value) {
  return static_cast<double>(value);
}

Value number(const std::optional<Seconds>& age) { return age ? Value(age->count()) : std::nullopt; }

Value watched(const Snapshot& s, double value) { return s.drift.watched ? Value(value) : std::nullopt; }

Value of_known(const Snapshot& s, double (*value)(const PoseReport::Known&)) {
  return s.pose.known ? Value(value(*s.pose.known)) : std::nullopt;
}

double unix_s(SystemTime time) { return Seconds(time.time_since_epoch()).count(); }

// clang-format off
constexpr std::array kHealthFigures{
    SensorFigure{"calibrd_sensor_frames_total", [](const Snapshot& s) -> Value { return number(s.sensor.frames); }},
    SensorFigure{"calibrd_sensor_frames_lost_total", [](const Snapshot& s) -> Value { return number(s.sensor.frames_lost); }},
    SensorFigure{"calibrd_sensor_frame_age_seconds", [](const Snapshot& s) { return number(s.sensor.frame_age); }},
    SensorFigure{"calibrd_sensor_frame_rate_hertz", [](const Snapshot& s) -> Value { return s.sensor.frame_rate_hz; }},
    SensorFigure{"calibrd_sensor_restarts_total", [](const Snapshot& s) -> Value { return number(s.sensor.restarts); }},
    SensorFigure{"calibrd_sensor_views_total", [](const Snapshot& s) -> Value { return number(s.sensor.views.views); }},
};
constexpr std::array kPoseFigures{
    SensorFigure{"calibrd_pose_valid", [](const Snapshot& s) -> Value { return number(s.pose.valid); }},
    SensorFigure{"calibrd_pose_calibrated_timestamp_seconds", [](const Snapshot& s) { return of_known(s, [](const PoseReport::Known& k) { return unix_s(k.calibrated_at); }); }},
    SensorFigure{"calibrd_pose_sigma_position_meters", [](const Snapshot& s) { return of_known(s, [](const PoseReport::Known& k) { return k.result.sigma_position_m; }); }},
    SensorFigure{"calibrd_pose_sigma_rotation_radians", [](const Snapshot& s) { return of_known(s, [](const PoseReport::Known& k) { return k.result.sigma_rotation_rad; }); }},
    SensorFigure{"calibrd_pose_passed_check_age_seconds", [](const Snapshot& s) { return number(s.pose.passed_check_age); }},
    SensorFigure{"calibrd_drift_statistic", [](const Snapshot& s) { return watched(s, s.drift.now.statistic); }},
    SensorFigure{"calibrd_drift_threshold", [](const Snapshot& s) { return watched(s, s.drift.now.threshold); }},
    SensorFigure{"calibrd_drift_shift_meters", [](const Snapshot& s) { return watched(s, s.drift.now.shift_m); }},
    SensorFigure{"calibrd_calibration_under_way", [](const Snapshot& s) -> Value { return number(!s.sensor.job.empty()); }},
};
// clang-format on

void write_figures(MetricsText& text, std::span<const SensorFigure> figures,
                   const std::vector<Snapshot>& all) {
  for (const auto& figure : figures) {
    text.begin(figure.family);
    for (const auto& snapshot : all)
      if (const auto value = figure.value(snapshot)) text.add({{"sensor", snapshot.sensor.id}}, *value);
  }
}

void write_states(MetricsText& text, const std::vector<Snapshot>& all) {
  const std::array poses{name_of(PoseState::uncalibrated), name_of(PoseState::calibrated),
                         name_of(PoseState::unverified), name_of(PoseState::drifted)};
  std::vector<const char*> verdicts;
  for (std::size_t i = 0; i < kDriftVerdicts; ++i)
    verdicts.push_back(calibrd::name_of(static_cast<DriftVerdict>(i)));
  text.begin("calibrd_sensor_health");
  for (const auto& s : all) text.add_states({{"sensor", s.sensor.id}}, "health", kHealths, s.sensor.health);
  text.begin("calibrd_sensor_frames_refused_total");
  for (const auto& s : all)
    for (const auto& [code, count] : s.sensor.views.refused)
      text.add({{"sensor", s.sensor.id}, {"code", code}}, number(count));
  text.begin("calibrd_pose_state");
  for (const auto& s : all) text.add_states({{"sensor", s.sensor.id}}, "state", poses, name_of(s.pose.state));
  text.begin("calibrd_drift_verdict");
  for (const auto& s : all)
    text.add_states({{"sensor", s.sensor.id}}, "verdict", verdicts, calibrd::name_of(s.drift.now.verdict));
}

void write_robot(MetricsText& text, const RobotReport& robot) {
  const auto one = [&](const char* family, Value value) {
    text.begin(family);
    if (value) text.add({}, *value);
  };
  one("calibrd_robot_connected", number(robot.link_state == "streaming"));
  text.begin("calibrd_robot_link_state");
  text.add_states({}, "state", kLinkStates, robot.link_state);
  one("calibrd_robot_joint_messages_total", robot.joints ? number(robot.joints->sequence) : 0);
  one("calibrd_robot_connects_total", number(robot.connects));
  one("calibrd_robot_reconnects_total", robot.connects > 0 ? number(robot.connects - 1) : 0);
  one("calibrd_robot_framing_errors_total", number(robot.framing_errors));
  one("calibrd_robot_rejected_messages_total", number(robot.rejected_values));
  one("calibrd_robot_joints_age_seconds", robot.joints ? Value(robot.joints_age.count()) : std::nullopt);
  one("calibrd_robot_joints_frozen", number(robot.joints_frozen));
  one("calibrd_robot_still", number(robot.still));
}

}  // namespace

void write_cell_metrics(const CellService& service, MetricsText& text) {
  const auto cell = service.cell();
  std::vector<Snapshot> all;
  for (const auto& sensor : cell.sensors) {
    const auto pose = service.pose(sensor.id);
    const auto drift = service.drift(sensor.id);
    if (pose && drift) all.push_back({sensor, *pose, *drift});
  }
  text.begin("calibrd_uptime_seconds");
  text.add({}, cell.uptime.count());
  write_robot(text, cell.robot);
  write_figures(text, kHealthFigures, all);
  write_figures(text, kPoseFigures, all);
  write_states(text, all);
  text.begin("calibrd_storage_ready");
  text.add({}, number(cell.storage.ready));
  text.begin("calibrd_storage_state");
  text.add_states({}, "state", kStorageStates, cell.storage.state);
}

}  // namespace calibrd::api
