// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/metrics/metric_table.hpp"

#include <algorithm>
#include <array>

namespace calibrd::api {
namespace {

constexpr auto counter = MetricType::counter;
constexpr auto gauge = MetricType::gauge;
constexpr auto histogram = MetricType::histogram;

// clang-format off
constexpr std::array kTable{
    MetricFamily{"calibrd_build_info", gauge, "version, compiler", "1; the labels say what is running."},
    MetricFamily{"calibrd_uptime_seconds", gauge, "", "Since the cell was taken up."},
    MetricFamily{"calibrd_thread_heartbeat_age_seconds", gauge, "thread", "Since a thread that must go on went on; above 10 the watchdog is no longer fed."},

    MetricFamily{"calibrd_http_requests_total", counter, "route, method, status", "Requests answered; route is the template of the path, \"unmatched\" where there is none or the client was not let in (its method is then \"any\")."},
    MetricFamily{"calibrd_http_request_duration_seconds", histogram, "route, method", "From the end of a request to its answer, the time asked for with ?wait= included."},
    MetricFamily{"calibrd_http_connections", gauge, "", "Connections being served."},
    MetricFamily{"calibrd_http_connections_accepted_total", counter, "", "Connections that were served."},
    MetricFamily{"calibrd_http_connections_refused_total", counter, "", "Connections that were told 503, or closed, because there were server.max_connections already."},
    MetricFamily{"calibrd_http_unreadable_requests_total", counter, "", "Requests that could not be read: no HTTP, too large, too slow, or broken off."},
    MetricFamily{"calibrd_http_unread_bytes", gauge, "", "Of answers that clients have not taken yet; one that several are sent counts once."},
    MetricFamily{"calibrd_event_subscribers", gauge, "", "Listeners to /api/v1/events."},

    MetricFamily{"calibrd_robot_connected", gauge, "", "1 while joints of the robot come in."},
    MetricFamily{"calibrd_robot_link_state", gauge, "state", "1 for the state of the link to the controller, 0 for the others."},
    MetricFamily{"calibrd_robot_joint_messages_total", counter, "", "Messages with joints received from the controller."},
    MetricFamily{"calibrd_robot_connects_total", counter, "", "Connections made to the controller."},
    MetricFamily{"calibrd_robot_reconnects_total", counter, "", "Connections made to the controller after the first."},
    MetricFamily{"calibrd_robot_framing_errors_total", counter, "", "What came from the controller and was no message."},
    MetricFamily{"calibrd_robot_rejected_messages_total", counter, "", "Messages dropped for values no robot has."},
    MetricFamily{"calibrd_robot_joints_age_seconds", gauge, "", "Age of the newest joints; absent before the first."},
    MetricFamily{"calibrd_robot_joints_frozen", gauge, "", "1 while joints repeat although the controller says that the robot moves."},
    MetricFamily{"calibrd_robot_still", gauge, "", "1 while the robot stands still."},

    MetricFamily{"calibrd_sensor_health", gauge, "sensor, health", "1 for the health of the sensor, 0 for the others."},
    MetricFamily{"calibrd_sensor_frames_total", counter, "sensor", "Frames delivered."},
    MetricFamily{"calibrd_sensor_frames_lost_total", counter, "sensor", "Frames lost on the way."},
    MetricFamily{"calibrd_sensor_frame_age_seconds", gauge, "sensor", "Age of the newest frame; absent before the first."},
    MetricFamily{"calibrd_sensor_frame_rate_hertz", gauge, "sensor", "Frames per second of the last two seconds."},
    MetricFamily{"calibrd_sensor_restarts_total", counter, "sensor", "Starts of the sensor's child process after the first."},
    MetricFamily{"calibrd_sensor_views_total", counter, "sensor", "Frames that became views."},
    MetricFamily{"calibrd_sensor_frames_refused_total", counter, "sensor, code", "Frames that did not become views; the codes are those of docs/api.md."},

    MetricFamily{"calibrd_pose_valid", gauge, "sensor", "1 while the pose may be used."},
    MetricFamily{"calibrd_pose_state", gauge, "sensor, state", "1 for the state of the pose, 0 for the others."},
    MetricFamily{"calibrd_pose_calibrated_timestamp_seconds", gauge, "sensor", "Unix time of the calibration whose pose it is; absent without one."},
    MetricFamily{"calibrd_pose_sigma_position_meters", gauge, "sensor", "Standard deviation of the pose's position; absent without a pose."},
    MetricFamily{"calibrd_pose_sigma_rotation_radians", gauge, "sensor", "Standard deviation of the pose's rotation; absent without a pose."},
    MetricFamily{"calibrd_pose_passed_check_age_seconds", gauge, "sensor", "Since the last check that agreed; absent before the first."},
    MetricFamily{"calibrd_drift_statistic", gauge, "sensor", "Of the test for a moved sensor; absent where none is watched."},
    MetricFamily{"calibrd_drift_threshold", gauge, "sensor", "The sensor has moved when the statistic is above it; absent where none is watched."},
    MetricFamily{"calibrd_drift_shift_meters", gauge, "sensor", "How far what the sensor sees has moved; absent where none is watched."},
    MetricFamily{"calibrd_drift_verdict", gauge, "sensor, verdict", "1 for the verdict of the drift watch, 0 for the others."},

    MetricFamily{"calibrd_calibrations_total", counter, "sensor, result", "Calibrations that ended: succeeded, uncertain or rejected by their verdict, failed without one, cancelled."},
    MetricFamily{"calibrd_calibration_duration_seconds", histogram, "sensor", "From the request of a calibration to its end, the wait for postures included."},
    MetricFamily{"calibrd_calibration_under_way", gauge, "sensor", "1 while a calibration of the sensor is under way."},

    MetricFamily{"calibrd_storage_ready", gauge, "", "1 while calibrations can be stored."},
    MetricFamily{"calibrd_storage_state", gauge, "state", "1 for the state of the store, 0 for the others."},
    MetricFamily{"calibrd_storage_database_bytes", gauge, "", "Size of the database with its write-ahead log."},

    MetricFamily{"calibrd_mqtt_connected", gauge, "", "1 while connected to the broker; this and what follows of it is absent without mqtt.host."},
    MetricFamily{"calibrd_mqtt_name_contested", gauge, "", "1 while another daemon speaks to the broker under this cell's name."},
    MetricFamily{"calibrd_mqtt_connects_total", counter, "", "Connections made to the broker."},
    MetricFamily{"calibrd_mqtt_calibrations_sent_total", counter, "", "Calibrations sent to the broker; one that is sent again counts again."},
    MetricFamily{"calibrd_mqtt_calibrations_acknowledged_total", counter, "", "Calibrations that a collector has stored."},
    MetricFamily{"calibrd_mqtt_calibrations_refused_total", counter, "", "Calibrations that a collector cannot store; the log says why."},
    MetricFamily{"calibrd_mqtt_calibrations_waiting", gauge, "", "Calibrations that no collector has acknowledged yet, as counted in the last five seconds."},

    MetricFamily{"process_cpu_seconds_total", counter, "", "Processor time taken, user and system."},
    MetricFamily{"process_resident_memory_bytes", gauge, "", "Resident memory."},
    MetricFamily{"process_virtual_memory_bytes", gauge, "", "Virtual memory."},
    MetricFamily{"process_open_fds", gauge, "", "Open file descriptors."},
    MetricFamily{"process_max_fds", gauge, "", "How many file descriptors may be open."},
    MetricFamily{"process_threads", gauge, "", "Threads."},
    MetricFamily{"process_start_time_seconds", gauge, "", "Unix time of the start of the process."},
};
// clang-format on

constexpr const char* kReferenceHead = R"(# Metrics

`GET /metrics` answers in the text format 0.0.4 of Prometheus. Units are seconds, metres, radians, bytes, as their names say.
The values of labels are bounded: templates of paths, ids of the configuration, names of this documentation. What is not known
is absent, not 0. The processes of the sensors (`calibrd-sensor`) are not in `process_*`. What to watch and which alarms to
set: [operations](operations.md). This page is generated: `calibrd metrics-reference > docs/metrics.md`.

| metric | type | labels | meaning |
|---|---|---|---|
)";

}  // namespace

std::span<const MetricFamily> metric_table() { return kTable; }

const MetricFamily* find_metric(std::string_view name) {
  const auto found = std::ranges::find_if(kTable, [&](const auto& row) { return row.name == name; });
  return found == kTable.end() ? nullptr : &*found;
}

const char* name_of(MetricType type) {
  if (type == MetricType::counter) return "counter";
  return type == MetricType::gauge ? "gauge" : "histogram";
}

std::string metrics_reference() {
  std::string page = kReferenceHead;
  for (const auto& family : kTable)
    page.append("| `")
        .append(family.name)
        .append("` | ")
        .append(name_of(family.type))
        .append(" | ")
        .append(family.labels)
        .append(" | ")
        .append(family.help)
        .append(" |\n");
  return page;
}

}  // namespace calibrd::api
