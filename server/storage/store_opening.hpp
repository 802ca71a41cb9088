// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "server/storage/saved_pose.hpp"
#include "server/storage/sqlite.hpp"

namespace calibrd {

/// Brings a database to today's schema. Errors: StorageError::newer_schema, or see Database::failure().
Status prepare_schema(Database& database);

/// Opens or makes the database of a store, with today's schema, and looks through all of it for damage, also
/// against the saved poses. Errors: StorageError, with the file's name. A damaged one is `salvaged`: the
/// current calibrations that can be read all the same are added, for sensors that are not yet among them.
Result<Database> open_whole(const std::filesystem::path& file, const std::string& vfs,
                            std::vector<SavedPose>& salvaged);

/// False: it is no store of ours that was damaged, but something else.
bool is_damaged_store(const std::filesystem::path& file, const Error& error);

/// Renames a database with what belongs to it to FILE.damaged-DATE and returns that name.
Result<std::filesystem::path> put_aside(const std::filesystem::path& file);

/// What was put aside and has not been taken away since; sorted.
std::vector<std::filesystem::path> find_put_aside(const std::filesystem::path& file);

}  // namespace calibrd
