// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "api/service/reports.hpp"
#include "core/base/result.hpp"

namespace calibrd::fleet {

/// A calibration that has ended and that no collector has acknowledged yet.
struct OutboxRow {
  std::int64_t number = 0;  ///< rising within a generation
  api::CalibrationReport calibration;
};

/// What waits to be told, on the disk. One thread at a time.
class Outbox {
 public:
  virtual ~Outbox() = default;
  /// Another one: numbers begin anew, as the database behind it is another one.
  virtual std::uint64_t generation() const = 0;
  /// Rows with a number above `after`, oldest first.
  virtual Result<std::vector<OutboxRow>> waiting(std::int64_t after, int limit) = 0;
  /// How many wait.
  virtual Result<std::int64_t> size() = 0;
  virtual Status remove(const std::vector<std::string>& calibration_ids) = 0;
};

}  // namespace calibrd::fleet
