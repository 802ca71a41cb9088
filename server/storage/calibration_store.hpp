// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "api/service/reports.hpp"
#include "core/base/result.hpp"
#include "server/storage/saved_pose.hpp"
#include "server/storage/sqlite.hpp"
#include "server/storage/store_lock.hpp"

namespace calibrd {

/// The calibration that was started with an Idempotency-Key.
struct KeyedStart {
  std::string calibration_id;
  std::string fingerprint;
};

/// A calibration that has ended and that no collector has acknowledged yet.
struct OutboxEntry {
  std::int64_t number = 0;  ///< rising within a generation of the outbox
  api::CalibrationReport calibration;
};

/// The calibration whose pose a sensor has.
struct CurrentCalibration {
  api::CalibrationReport calibration;
  std::string basis;  ///< what its pose was found with, as stated when it was activated
  bool drifted = false;
};

/// Every calibration ever made, in an SQLite file. Rows are only ever added: the schema refuses to change or
/// delete one. A call that returns Done has reached the disk. The current calibration of each sensor is kept
/// a second time, in FILE.last (see SavedPose): where the database cannot be used, it is known all the same,
/// and nothing else; writing is refused until look() finds the database again. Safe to call from any thread;
/// calls wait for each other and for the disk. Errors: StorageError.
class CalibrationStore {
 public:
  /// Opens or makes the store; its folder is made when absent. It belongs to this process until it is closed.
  /// Calibrations that had not ended when the last daemon did are recorded as failed. A damaged database is
  /// put aside, and a new one begun with the current calibrations. `vfs`: see Database::open(). Error: there
  /// is no store, and no saved pose either.
  static Result<std::unique_ptr<CalibrationStore>> open(const std::filesystem::path& file,
                                                        const std::string& vfs = {});

  /// Whether it can be written. Never waits.
  api::StorageReport report() const;

  /// Tries what has failed before, and looks for room on the disk; to be called every few seconds.
  void look();

  /// Records that a calibration was asked for.
  Status add(const api::CalibrationReport& calibration, const api::CalibrationRequest& request);

  /// Records how it ended, with its evidence; once for each calibration. `activated_with`: it becomes its
  /// sensor's current one in the same stroke, found with this basis (see CurrentCalibration).
  Status finish(const api::CalibrationReport& calibration,
                const std::optional<std::string>& activated_with = {});

  /// An end that could not be recorded is known until look() can record it.
  void owe_end(const api::CalibrationReport& calibration);

  /// Makes a stored calibration the current one of its sensor. `basis`: see CurrentCalibration.
  Status activate(const api::CalibrationReport& calibration, const std::string& basis);

  /// Records that the calibration's pose has drifted, if it is its sensor's current one. It has until it is
  /// activated again. Where it cannot be recorded, look() tries again.
  Status add_drift(const std::string& calibration_id);

  /// Keeps the depths (m, 0 = unknown; kept to 0.1 mm, up to 6.5 m) of what a calibration's sensor saw around
  /// the robot. The first ones stay.
  Status add_background(const std::string& calibration_id, const std::vector<float>& depth_m);
  /// Nothing where none were kept, or they are damaged.
  Result<std::optional<std::vector<float>>> background(const std::string& calibration_id);

  Result<std::optional<api::CalibrationReport>> find(const std::string& id);
  Result<std::optional<CurrentCalibration>> current(const std::string& sensor_id);
  Result<api::HistoryPage> history(const api::HistoryQuery& query);
  Result<std::optional<KeyedStart>> find_start(const std::string& sensor_id,
                                               const std::string& idempotency_key);

  /// Changes whenever another database takes the place of the one that was used: its numbers begin anew.
  /// Never waits.
  std::uint64_t outbox_generation() const { return generation_; }
  /// What ended and was not acknowledged, with numbers above `after`, oldest first, with evidence.
  Result<std::vector<OutboxEntry>> outbox(std::int64_t after, int limit);
  /// How many that are.
  Result<std::int64_t> outbox_size();
  /// These were acknowledged.
  Status remove_from_outbox(const std::vector<std::string>& calibration_ids);

 private:
  CalibrationStore(std::filesystem::path file, std::string vfs)
      : file_(std::move(file)), vfs_(std::move(vfs)) {}

  template <class Call>
  auto guarded(const Call& call) -> decltype(call());
  Status write(const std::string& sensor_id, const std::function<Status()>& statements);
  Status write_now(const std::function<Status()>& statements);
  Status insert_start(const api::CalibrationReport& calibration, const api::CalibrationRequest& request);
  Status insert_end(const api::CalibrationReport& calibration);
  Status insert_activation(const api::CalibrationReport& calibration, const std::string& basis);
  Status insert_drift(const std::string& calibration_id);
  Status drop_old_backgrounds(const std::string& calibration_id);
  Result<std::optional<api::CalibrationReport>> find_row(const std::string& id);

  Status begin();
  Status take_up();
  Result<Database> open_or_replace(std::vector<SavedPose>& saved);
  Status recover(Database& database, const std::vector<SavedPose>& saved);
  Status stand_in(const Error& error);
  Status end_interrupted();
  void save_current(const std::string& sensor_id);
  void save_current_of(const std::string& calibration_id);
  void save_all_current();
  void try_again();
  void pay_owed();
  void look_at_disk();
  void note(const Status& status);
  void update_report();
  api::StorageReport make_report() const;

  const std::filesystem::path file_;
  const std::string vfs_;

  std::mutex mutex_;  // guards what follows
  std::optional<StoreLock> lock_;
  std::optional<Database> database_;            // where it cannot be used: one in memory, of the saved poses
  std::optional<Error> unusable_;               // why it cannot
  std::optional<Error> failure_;                // of the last write, or of a read of something damaged
  std::optional<Error> little_room_;            // on the disk
  std::string put_aside_;                       // the newest damaged database beside it
  std::map<std::string, std::string> unsaved_;  // sensors whose second copy is behind, and why
  bool has_ended_interrupted_ = false;
  bool is_behind_ = false;                                   // some second copy may be
  std::map<std::string, api::CalibrationReport> owed_ends_;  // by id
  std::set<std::string> owed_drifts_;                        // calibration ids

  std::atomic<std::uint64_t> generation_ = 0;  // of database_

  mutable std::mutex report_mutex_;
  api::StorageReport report_;  // guarded by report_mutex_
};

}  // namespace calibrd
