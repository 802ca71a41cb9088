// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
//
// The part of CalibrationStore that opens the database, does without it, and finds it again.
#include <sys/statvfs.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "server/storage/durable_file.hpp"
#include "server/storage/guarded.hpp"
#include "server/storage/saved_pose_rows.hpp"
#include "server/storage/store_opening.hpp"

namespace calibrd {
namespace {

constexpr const char* kInterrupted = "The daemon ended before this calibration did; start it again.";
constexpr const char* kRecovered =
    "Taken over from the saved pose: the database of that time was damaged or is gone.";
constexpr double kRoom_bytes = 8e6;  // a calibration with its background takes up to 2 MB, twice for a moment

/// Of another process, or another time: not to be worked around.
bool is_foreign(const Error& error) {
  return error.code == StorageError::in_use || error.code == StorageError::newer_schema ||
         error.code == StorageError::not_a_store;
}

/// The second copy is of this calibration, if perhaps not as it is now.
bool is_saved(const std::filesystem::path& folder, const SavedPose& pose) {
  const auto saved = read_saved_poses(folder);
  return std::ranges::any_of(saved, [&](const SavedPose& other) {
    return other.sensor_id == pose.sensor_id && other.calibration_id == pose.calibration_id;
  });
}

std::string state_of(const Error& error) {
  if (error.code == StorageError::full) return "full";
  if (error.code == StorageError::read_only) return "read_only";
  return error.code == StorageError::damaged ? "damaged" : "failing";
}

}  // namespace

Result<std::unique_ptr<CalibrationStore>> CalibrationStore::open(const std::filesystem::path& file,
                                                                 const std::string& vfs) {
  try {
    std::unique_ptr<CalibrationStore> store(new CalibrationStore(file, vfs));
    if (auto begun = store->guarded([&] { return store->begin(); }); !begun) return begun.error();
    return store;
  } catch (const std::bad_alloc&) {
    return Error{StorageError::out_of_memory, {}};
  }
}

Status CalibrationStore::begin() {
  const auto taken = take_up();
  if (!taken && (is_foreign(taken.error()) || read_saved_poses(saved_pose_folder(file_)).empty()))
    return taken.error();
  const auto begun = taken ? taken : stand_in(taken.error());
  look_at_disk();
  update_report();
  return begun;
}

/// Makes the database on the disk the one that is used.
Status CalibrationStore::take_up() {
  if (auto made = make_folders_durably(file_.parent_path()); !made) return made;
  if (!lock_) {
    auto lock = StoreLock::take(file_);
    if (!lock) return lock.error();
    lock_.emplace(*std::move(lock));
  }
  auto saved = read_saved_poses(saved_pose_folder(file_));
  auto opened = open_or_replace(saved);
  if (!opened) return opened.error();
  if (auto recovered = recover(*opened, saved); !recovered)
    return Error{recovered.error().code, file_.string() + " (" + recovered.error().detail + ")"};
  unusable_.reset();
  failure_.reset();
  database_.emplace(*std::move(opened));
  ++generation_;
  // Only those of the last daemon: what this one has begun while it had no database goes on.
  const auto ended = has_ended_interrupted_ ? Status(Done{}) : end_interrupted();
  if (!ended) {
    const Error error{ended.error().code, file_.string() + " (" + ended.error().detail + ")"};
    const auto stands = stand_in(error);
    return stands ? error : stands.error();
  }
  has_ended_interrupted_ = true;
  save_all_current();
  return Done{};
}

Result<Database> CalibrationStore::open_or_replace(std::vector<SavedPose>& saved) {
  auto opened = open_whole(file_, vfs_, saved);
  if (opened || !is_damaged_store(file_, opened.error())) return opened;
  for (const auto& pose : saved)
    (void)save_pose(saved_pose_folder(file_), pose);  // before it is out of reach
  if (auto aside = put_aside(file_); !aside) return aside.error();
  return open_whole(file_, vfs_, saved);
}

/// A database without any calibration, where there are saved poses, takes the place of one that is lost.
Status CalibrationStore::recover(Database& database, const std::vector<SavedPose>& saved) {
  const auto is_used = has_calibrations(database);
  if (!is_used) return is_used.error();
  if (*is_used || saved.empty()) return Done{};
  Transaction transaction(database);
  for (const auto& pose : saved)
    if (auto inserted = insert_saved_pose(database, pose, kRecovered); !inserted) return inserted;
  return transaction.commit();
}

/// Without the database on the disk: the saved poses, in memory, and nothing may be written. The one on the
/// disk is closed: what is put aside must not be open, SQLite would remove the journal of its successor.
Status CalibrationStore::stand_in(const Error& error) {
  auto memory = Database::open(":memory:");
  if (!memory) return memory.error();
  if (auto prepared = prepare_schema(*memory); !prepared) return prepared;
  if (auto filled = recover(*memory, read_saved_poses(saved_pose_folder(file_))); !filled) return filled;
  database_.emplace(*std::move(memory));
  ++generation_;
  unusable_ = error;
  return Done{};
}

Status CalibrationStore::end_interrupted() {
  const auto now = std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::system_clock::now().time_since_epoch());
  return write_now([&] {
    Statement insert(
        *database_,
        "INSERT INTO results (calibration_id, finished_ms, status, message, postures_seen, result) "
        "SELECT id, ?, 'failed', ?, 0, NULL FROM calibrations "
        "WHERE id NOT IN (SELECT calibration_id FROM results)");
    insert.bind(now.count()).bind(std::string(kInterrupted)).next();
    return insert.status(StorageError::cannot_write);
  });
}

/// Keeps the second copy of a sensor's current calibration in step. None is better than that of another
/// calibration, and one that lacks the newest of its background or drift better than none: on a full disk it
/// may be all that the next start can read. What was written to the database stays written, also where there
/// is no memory for this: then look() does it.
void CalibrationStore::save_current(const std::string& sensor_id) {
  try {
    const auto folder = saved_pose_folder(file_);
    const auto pose = select_current(*database_, sensor_id);
    auto saved = pose ? Status(Done{}) : Status(pose.error());
    if (pose && *pose) saved = save_pose(folder, **pose);
    unsaved_.erase(sensor_id);
    if (!saved) {
      if (pose && *pose && !is_saved(folder, **pose)) forget_pose(folder, sensor_id);
      unsaved_.emplace(sensor_id, saved.error().message());
    }
  } catch (const std::bad_alloc&) {
    is_behind_ = true;
  }
  update_report();
}

void CalibrationStore::save_current_of(const std::string& calibration_id) {
  try {
    Statement query(*database_, "SELECT sensor_id FROM calibrations WHERE id = ?");
    query.bind(calibration_id);
    if (query.next())
      save_current(query.text(0));
    else
      is_behind_ = true;
  } catch (const std::bad_alloc&) {
    is_behind_ = true;
  }
}

void CalibrationStore::save_all_current() {
  is_behind_ = false;
  for (const auto& pose : select_all_current(*database_)) save_current(pose.sensor_id);
}

void CalibrationStore::look() {
  (void)guarded([&]() -> Status {
    try_again();
    if (!unusable_) pay_owed();
    look_at_disk();
    update_report();
    return Done{};
  });
}

void CalibrationStore::try_again() {
  if (failure_ && failure_->code == StorageError::damaged && !unusable_) {
    if (auto stands = stand_in(*failure_); !stands) failure_ = stands.error();
  }
  if (unusable_) {
    if (auto taken = take_up(); !taken) unusable_ = taken.error();
  } else if (failure_ || little_room_) {
    (void)write_now([&] {  // writes the number that is there
      return database_->run("PRAGMA application_id = 0", StorageError::cannot_write);
    });
  }
  if (unusable_ || failure_) return;
  if (is_behind_ || !unsaved_.empty()) save_all_current();
}

void CalibrationStore::pay_owed() {
  while (!failure_ && !owed_ends_.empty()) {
    const auto owed = owed_ends_.begin()->second;
    (void)write_now([&] { return insert_end(owed); });
    if (!failure_ || failure_->code == StorageError::contradiction) owed_ends_.erase(owed.id);
  }
  while (!failure_ && !owed_drifts_.empty()) {
    const auto owed = *owed_drifts_.begin();
    if (!write_now([&] { return insert_drift(owed); })) break;
    owed_drifts_.erase(owed);
    save_current_of(owed);
  }
}

void CalibrationStore::look_at_disk() {
  const auto aside = find_put_aside(file_);
  put_aside_ = aside.empty() ? std::string() : aside.back().string();
  little_room_.reset();
  struct statvfs disk {};
  const auto folder = file_.has_parent_path() ? file_.parent_path() : std::filesystem::path(".");
  if (::statvfs(folder.c_str(), &disk) != 0) return;
  const double room = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize);
  if ((disk.f_flag & ST_RDONLY) != 0)
    little_room_ = Error{StorageError::read_only, folder.string()};
  else if (room < kRoom_bytes)
    little_room_ = Error{StorageError::full,
                         folder.string() + " (" + std::to_string(static_cast<int>(room / 1e6)) + " MB left)"};
}

void CalibrationStore::note(const Status& status) {
  if (status)
    failure_.reset();
  else
    failure_ = status.error();
  update_report();
}

void CalibrationStore::update_report() {
  try {
    auto report = make_report();
    const std::lock_guard lock(report_mutex_);
    report_ = std::move(report);
  } catch (const std::bad_alloc&) {
    return;  // what was written stays written; look() reports again
  }
}

api::StorageReport CalibrationStore::make_report() const {
  if (const auto& hindrance = unusable_ ? unusable_ : failure_ ? failure_ : little_room_)
    return {false, state_of(*hindrance), hindrance->message()};
  if (!unsaved_.empty()) {
    const auto& [sensor_id, error] = *unsaved_.begin();
    return {true, "unsaved", "the second copy of the pose of " + sensor_id + " is not written: " + error};
  }
  if (put_aside_.empty()) return {};
  return {true, "recovered",
          "a damaged calibration store was put aside as " + put_aside_ +
              "; a new one was begun with the last poses. Check the disk, keep that file where you need its "
              "history, and move it away"};
}

api::StorageReport CalibrationStore::report() const {
  const std::lock_guard lock(report_mutex_);
  return report_;
}

}  // namespace calibrd
