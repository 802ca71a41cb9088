// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace calibrd::fleet {

/// Which calibrations are sent when: a window over the outbox of which each is sent again, ever more seldom,
/// until it is acknowledged. Does no I/O.
class ExportWindow {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit ExportWindow(std::size_t capacity) : capacity_(capacity) {}

  std::size_t room() const { return capacity_ - std::min(capacity_, waiting_.size()); }
  /// Whose numbers are meant from now on; of another generation they begin anew.
  void follow(std::uint64_t generation);
  /// The outbox is to be read from after this number.
  std::int64_t newest() const { return newest_; }
  std::size_t size() const { return waiting_.size(); }

  void add(std::int64_t number, std::string id, std::string payload);

  /// What is to be sent now, in order; it counts as sent.
  std::vector<std::string> take_due(Time now);

  /// The broker or the collector has changed: what was sent may be lost.
  void send_all_again();

  /// As send_all_again(), and the outbox is read from its beginning: what was dropped as refused is tried
  /// once more.
  void begin_anew();

  /// No longer to be sent, as it was stored or never can be. False: it was not in the window.
  bool drop(const std::string& id);

 private:
  struct Row {
    std::string payload;
    std::int64_t number = 0;
    std::chrono::seconds pause{0};  ///< 0: not sent yet
    Time due{};
  };
  std::size_t capacity_;
  std::uint64_t generation_ = 0;
  std::int64_t newest_ = 0;             // of this generation
  std::map<std::string, Row> waiting_;  // by id: dated, so oldest first
};

}  // namespace calibrd::fleet
