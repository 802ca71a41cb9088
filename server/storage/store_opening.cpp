// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/store_opening.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>

#include "api/json/calibration_result_json.hpp"
#include "core/base/utc_text.hpp"
#include "server/storage/durable_file.hpp"
#include "server/storage/saved_pose_rows.hpp"
#include "server/storage/schema.hpp"

namespace calibrd {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "SQLite format 3";

std::string damaged_prefix(const fs::path& file) { return file.filename().string() + ".damaged-"; }

/// Of the file's structure. That every table is there at all, SQLite does not ask.
Status check_structure(Database& database) {
  Statement check(database, "PRAGMA quick_check(1)");
  const auto words = check.next() ? check.text(0) : std::string();
  if (auto status = check.status(StorageError::cannot_read); !status) return status;
  if (words != "ok") return Error{StorageError::damaged, words};
  for (const char* table :
       {"calibrations", "results", "activations", "drifts", "backgrounds", "evidence", "outbox"}) {
    Statement query(database, std::string("SELECT 1 FROM ") + table + " LIMIT 1");
    query.next();
    if (auto status = query.status(StorageError::damaged); !status) return status;
  }
  return Done{};
}

bool is_readable(const SavedPose& pose) {
  const auto result = api::parse_calibration_result(pose.result);
  return result && result->T_base_sensor;
}

Status check_whole(Database& database, const std::vector<SavedPose>& saved) {
  if (auto prepared = prepare_schema(database); !prepared) return prepared;
  if (auto checked = check_structure(database); !checked) return checked;
  for (const auto& pose : saved)
    if (auto checked = check_against(database, pose); !checked) return checked;
  return Done{};
}

Result<Database> open_checked(const fs::path& file, const std::string& vfs,
                              std::vector<SavedPose>& salvaged) {
  auto database = Database::open(file, vfs);
  if (!database) return database;
  const auto checked = check_whole(*database, salvaged);
  if (checked) return database;
  for (auto& pose : select_all_current(*database))
    if (is_readable(pose) && std::none_of(salvaged.begin(), salvaged.end(), [&](const auto& other) {
          return other.sensor_id == pose.sensor_id;
        }))
      salvaged.push_back(std::move(pose));
  return Error{checked.error().code, file.string() + " (" + checked.error().detail + ")"};
}

}  // namespace

Status prepare_schema(Database& database) {
  std::int64_t version = 0;
  {
    Statement query(database, "PRAGMA user_version");
    if (query.next()) version = query.number(0);
    if (auto status = query.status(StorageError::cannot_read); !status) return status;
  }
  const auto newest = static_cast<std::int64_t>(kSchemaSteps.size());
  if (version == newest) return Done{};
  if (version > newest || version < 0)
    return Error{StorageError::newer_schema, "schema " + std::to_string(version)};
  Transaction transaction(database);
  for (auto step = version; step < newest; ++step)
    if (auto taken = database.run(kSchemaSteps[static_cast<std::size_t>(step)], StorageError::cannot_write);
        !taken)
      return taken;
  if (auto numbered =
          database.run("PRAGMA user_version = " + std::to_string(newest), StorageError::cannot_write);
      !numbered)
    return numbered;
  return transaction.commit();
}

Result<Database> open_whole(const fs::path& file, const std::string& vfs, std::vector<SavedPose>& salvaged) {
  auto opened = open_checked(file, vfs, salvaged);
  // What cannot be read once looks like damage, too: only what is damaged twice is.
  if (!opened && opened.error().code == StorageError::damaged) opened = open_checked(file, vfs, salvaged);
  return opened;
}

bool is_damaged_store(const fs::path& file, const Error& error) {
  if (error.code == StorageError::damaged) return true;
  if (error.code != StorageError::not_a_store) return false;
  std::string begin(kMagic.size(), '\0');
  std::ifstream(file, std::ios::binary).read(begin.data(), static_cast<std::streamsize>(begin.size()));
  std::error_code unreadable;
  return begin == kMagic || fs::exists(saved_pose_folder(file), unreadable);
}

Result<fs::path> put_aside(const fs::path& file) {
  auto aside =
      file.parent_path() / (damaged_prefix(file) + utc_text(std::chrono::system_clock::now(), kUtcCompact));
  std::error_code unreadable;
  while (fs::exists(aside, unreadable)) aside += "+";
  for (const char* ending : {"", "-wal", "-shm"}) {
    auto from = file, to = aside;
    from += ending;
    to += ending;
    if (::rename(from.c_str(), to.c_str()) != 0 && errno != ENOENT) return file_error(errno, from);
  }
  if (auto synced = sync_folder(file.parent_path()); !synced) return synced.error();
  return aside;
}

std::vector<fs::path> find_put_aside(const fs::path& file) {
  std::vector<fs::path> found;
  const auto prefix = damaged_prefix(file);
  for (const auto& name : names_in(file.parent_path())) {
    const bool is_companion = name.ends_with("-wal") || name.ends_with("-shm");
    if (name.starts_with(prefix) && !is_companion) found.push_back(file.parent_path() / name);
  }
  return found;
}

}  // namespace calibrd
