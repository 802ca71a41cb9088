// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "api/service/reports.hpp"
#include "core/base/result.hpp"
#include "server/storage/sqlite.hpp"
#include "server/storage/store_lock.hpp"

namespace calibrd {

/// The calibration that was started with an Idempotency-Key.
struct KeyedStart {
  std::string calibration_id;
  std::string fingerprint;
};

/// The calibration whose pose a sensor has.
struct CurrentCalibration {
  api::CalibrationReport calibration;
  std::string basis;  ///< what its pose was found with, as stated when it was activated
  bool drifted = false;
};

/// Every calibration ever made, in an SQLite file. Rows are only ever added: the schema refuses to change or
/// delete one. A call that returns Done has reached the disk. Safe to call from any thread; calls wait for
/// each other and for the disk. Errors: StorageError.
class CalibrationStore {
 public:
  /// Opens or makes the store; its folder is made when absent. It belongs to this process until it is closed.
  /// Calibrations that had not ended when the last daemon did are recorded as failed.
  /// `vfs`: see Database::open().
  static Result<std::unique_ptr<CalibrationStore>> open(const std::filesystem::path& file,
                                                        const std::string& vfs = {});

  /// Records that a calibration was asked for.
  Status add(const api::CalibrationReport& calibration, const api::CalibrationRequest& request);

  /// Records how it ended; once for each calibration. `activated_with`: it becomes its sensor's current one
  /// in the same stroke, found with this basis (see CurrentCalibration).
  Status finish(const api::CalibrationReport& calibration,
                const std::optional<std::string>& activated_with = {});

  /// Makes a stored calibration the current one of its sensor. `basis`: see CurrentCalibration.
  Status activate(const api::CalibrationReport& calibration, const std::string& basis);

  /// Records that the calibration's pose has drifted, if it is its sensor's current one. It has until it is
  /// activated again.
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

 private:
  CalibrationStore(StoreLock lock, Database database)
      : lock_(std::move(lock)), database_(std::move(database)) {}
  Status prepare_schema();
  Status end_interrupted();
  Status write(const std::function<Status()>& statements);
  Status insert_activation(const api::CalibrationReport& calibration, const std::string& basis);
  Result<std::optional<api::CalibrationReport>> find_where(const std::string& condition,
                                                           const std::string& value);

  const StoreLock lock_;
  std::mutex mutex_;
  Database database_;  // guarded by mutex_
};

}  // namespace calibrd
