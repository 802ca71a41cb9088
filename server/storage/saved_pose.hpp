// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.hpp"

namespace calibrd {

/// The current calibration of a sensor, as it is kept a second time: in a small file beside the database, so
/// that its pose outlives the database.
struct SavedPose {
  std::string sensor_id, calibration_id;
  std::int64_t created_ms = 0, finished_ms = 0;
  std::string method;
  std::int64_t postures = 0, postures_seen = 0;
  std::string result;  ///< JSON, as in the database
  std::string basis;   ///< see CurrentCalibration
  bool drifted = false;
  std::string background;  ///< as in the database; empty: none

  bool operator==(const SavedPose&) const = default;
};

/// A line of JSON, and a second one with its checksum.
std::string saved_pose_text(const SavedPose& pose);
/// Error: StorageError::damaged.
Result<SavedPose> parse_saved_pose(const std::string& text);

/// The folder of these files: calibrd.db.last
std::filesystem::path saved_pose_folder(const std::filesystem::path& database);
/// Makes the folder where it is absent. Errors: see write_durably().
Status save_pose(const std::filesystem::path& folder, const SavedPose& pose);
/// A pose that is not current any more must not be taken for it after a fault.
void forget_pose(const std::filesystem::path& folder, const std::string& sensor_id);
/// Those that can be read and are whole.
std::vector<SavedPose> read_saved_poses(const std::filesystem::path& folder);

}  // namespace calibrd
