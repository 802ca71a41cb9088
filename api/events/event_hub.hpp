// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace calibrd::api {

/// One thing that has changed in the cell, for a server-sent event.
struct Event {
  std::uint64_t number = 0;  ///< grows by one from event to event
  std::string type;          ///< "pose", "calibration", …
  std::string data;          ///< one line of JSON
};

/// What those who listen have to be told next.
struct EventBatch {
  bool is_whole_state = false;  ///< the newest event of each subject: what was before cannot be told any more
  std::vector<Event> events;    ///< oldest first
  std::uint64_t last = 0;       ///< number to go on after
};

/// Keeps what has changed: the newest event of each subject, and the last thousand in order, so that a
/// listener who was away goes on where it was. Numbers mean nothing to another run of the daemon: ids name
/// the run. Safe to call from any thread.
class EventHub {
 public:
  /// `run`: another one each time the daemon is started.
  explicit EventHub(std::string run) : run_(std::move(run)) {}

  /// Says how `subject` ("pose/kinect2") is now; nothing happens where that was said last.
  void publish(const std::string& subject, std::string type, std::string data);

  /// All after `number`; the whole state where that is not known, or too long ago.
  EventBatch after(std::optional<std::uint64_t> number) const;

  /// "RUN-17" for event 17.
  std::string id_of(std::uint64_t number) const { return run_ + "-" + std::to_string(number); }
  /// The number of an id of this run; nothing for any other text.
  std::optional<std::uint64_t> number_of(std::string_view id) const;

  /// One who listens, as long as it lives.
  class Listener {
   public:
    explicit Listener(const EventHub& hub) : hub_(hub) { ++hub_.listeners_; }
    ~Listener() { --hub_.listeners_; }
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;

   private:
    const EventHub& hub_;
  };
  int listeners() const { return listeners_; }

  static constexpr std::size_t kKept = 1000;

 private:
  const std::string run_;
  mutable std::atomic<int> listeners_{0};
  mutable std::mutex mutex_;  // guards what follows
  std::uint64_t last_ = 0;
  std::deque<Event> kept_;
  std::map<std::string, Event> newest_;  // by subject
};

}  // namespace calibrd::api
