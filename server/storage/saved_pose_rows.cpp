// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/saved_pose_rows.hpp"

#include <chrono>

namespace calibrd {
namespace {

constexpr const char* kSelect =
    "SELECT c.sensor_id, c.id, c.created_ms, r.finished_ms, c.method, c.postures, r.postures_seen, r.result, "
    "a.basis, a.number IN (SELECT activation FROM drifts), b.depths FROM activations a "
    "JOIN calibrations c ON c.id = a.calibration_id JOIN results r ON r.calibration_id = c.id "
    "LEFT JOIN backgrounds b ON b.calibration_id = c.id "
    "WHERE a.sensor_id = ? ORDER BY a.number DESC LIMIT 1";

SavedPose pose_of(const Statement& row) {
  SavedPose pose;
  pose.sensor_id = row.text(0);
  pose.calibration_id = row.text(1);
  pose.created_ms = row.number(2);
  pose.finished_ms = row.number(3);
  pose.method = row.text(4);
  pose.postures = row.number(5);
  pose.postures_seen = row.number(6);
  pose.result = row.text(7);
  pose.basis = row.text(8);
  pose.drifted = row.number(9) != 0;
  pose.background = row.text(10);
  return pose;
}

}  // namespace

Result<std::optional<SavedPose>> select_current(Database& database, const std::string& sensor_id) {
  Statement query(database, kSelect);
  query.bind(sensor_id);
  std::optional<SavedPose> pose;
  if (query.next()) pose = pose_of(query);
  if (auto status = query.status(StorageError::cannot_read); !status) return status.error();
  return pose;
}

std::vector<SavedPose> select_all_current(Database& database) {
  std::vector<std::string> sensors;
  Statement query(database, "SELECT DISTINCT sensor_id FROM activations");
  while (query.next()) sensors.push_back(query.text(0));
  std::vector<SavedPose> poses;
  for (const auto& sensor : sensors)
    if (auto pose = select_current(database, sensor); pose && *pose) poses.push_back(**std::move(pose));
  return poses;
}

Status insert_saved_pose(Database& database, const SavedPose& pose, const std::string& message) {
  const auto now = std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::system_clock::now().time_since_epoch());
  Statement calibration(
      database,
      "INSERT INTO calibrations (id, sensor_id, created_ms, method, postures, activate, fingerprint) "
      "VALUES (?, ?, ?, ?, ?, 1, '')");
  calibration.bind(pose.calibration_id).bind(pose.sensor_id).bind(pose.created_ms).bind(pose.method);
  calibration.bind(pose.postures).next();
  Statement result(
      database,
      "INSERT INTO results (calibration_id, finished_ms, status, message, postures_seen, result) "
      "VALUES (?, ?, 'succeeded', ?, ?, ?)");
  result.bind(pose.calibration_id).bind(pose.finished_ms).bind(message);
  result.bind(pose.postures_seen).bind(pose.result).next();
  Statement activation(
      database,
      "INSERT INTO activations (sensor_id, calibration_id, activated_ms, basis) VALUES (?, ?, ?, ?)");
  activation.bind(pose.sensor_id).bind(pose.calibration_id).bind(now.count()).bind(pose.basis).next();
  Statement drift(database,
                  "INSERT INTO drifts (activation, found_ms) SELECT MAX(number), ? FROM activations WHERE ?");
  if (pose.drifted) drift.bind(now.count()).bind(1).next();
  Statement background(database, "INSERT INTO backgrounds (calibration_id, depths) VALUES (?, ?)");
  if (!pose.background.empty()) background.bind(pose.calibration_id).bind(pose.background).next();
  for (const auto* statement : {&calibration, &result, &activation, &drift, &background})
    if (auto status = statement->status(StorageError::cannot_write); !status) return status;
  return Done{};
}

Status check_against(Database& database, const SavedPose& pose) {
  Statement query(database, "SELECT result FROM results WHERE calibration_id = ?");
  query.bind(pose.calibration_id);
  const bool differs = query.next() && query.text(0) != pose.result;
  if (auto status = query.status(StorageError::cannot_read); !status) return status;
  if (differs) return Error{StorageError::damaged, "result of " + pose.calibration_id};
  return Done{};
}

Result<bool> has_calibrations(Database& database) {
  Statement query(database, "SELECT 1 FROM calibrations LIMIT 1");
  const bool has_some = query.next();
  if (auto status = query.status(StorageError::cannot_read); !status) return status.error();
  return has_some;
}

}  // namespace calibrd
