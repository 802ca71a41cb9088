// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace calibrd::fleet {

/// A calibration as a cell sent it.
struct Arrival {
  std::string cell, calibration_id;
  std::string document;  ///< JSON
};

/// What has arrived and is not stored yet, each calibration once however often it was sent. Bounded: what
/// does not fit is dropped, and its daemon sends it again. Safe to use from any thread.
class Inbox {
 public:
  /// `capacity`: calibrations, and bytes of all documents together.
  Inbox(std::size_t capacity, std::size_t bytes) : capacity_(capacity), most_bytes_(bytes) {}

  void put(Arrival arrival);

  /// Takes up to `most`, and, but for the first, up to so many bytes; waits for the first until `patience`
  /// has passed.
  std::vector<Arrival> take(std::size_t most, std::size_t bytes, std::chrono::milliseconds patience);

  std::size_t size() const;

 private:
  using Key = std::pair<std::string, std::string>;
  const std::size_t capacity_, most_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable change_;
  std::map<Key, std::string> waiting_;  // guarded by mutex_
  std::size_t bytes_ = 0;               // guarded by mutex_; of the documents that wait
};

}  // namespace calibrd::fleet
