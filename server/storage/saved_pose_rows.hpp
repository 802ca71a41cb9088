// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "server/storage/saved_pose.hpp"
#include "server/storage/sqlite.hpp"

namespace calibrd {

// Saved poses from the database, and into it. Errors: StorageError.

/// What saved_pose.hpp keeps of a sensor; nothing where it has no current calibration.
Result<std::optional<SavedPose>> select_current(Database& database, const std::string& sensor_id);
/// The current one of every sensor, as far as it can be read.
std::vector<SavedPose> select_all_current(Database& database);
/// The calibration as it was, and made current again. `message`: where it comes from.
Status insert_saved_pose(Database& database, const SavedPose& pose, const std::string& message);
/// StorageError::damaged where the database tells another result of the same calibration: SQLite does not
/// notice a number that has changed on the disk, the saved pose has a checksum.
Status check_against(Database& database, const SavedPose& pose);
Result<bool> has_calibrations(Database& database);

}  // namespace calibrd
