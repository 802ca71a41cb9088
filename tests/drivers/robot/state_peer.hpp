// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "drivers/robot/joint_source.hpp"

namespace calibrd {

/// How long a test waits for something that must happen.
constexpr std::chrono::seconds kPatience{10};

/// The controller's end of one connection. Closes orderly when destroyed.
class PeerConnection {
 public:
  explicit PeerConnection(int handle) : handle_(handle) {}
  PeerConnection(PeerConnection&& other) noexcept : handle_(other.release()) {}
  PeerConnection& operator=(PeerConnection&& other) noexcept;
  ~PeerConnection() { close(); }

  void send(std::span<const std::byte> bytes);
  void send_byte_by_byte(std::span<const std::byte> bytes);  ///< each in a segment of its own
  void close();                                              ///< FIN
  void reset();                                              ///< RST
  /// Everything the client sends until it has sent `count` bytes or closed.
  std::vector<std::byte> receive(std::size_t count);
  /// Waits until the client closes; true when it had sent nothing.
  bool client_closes_without_a_word() { return receive(1).empty(); }

 private:
  int release() { return std::exchange(handle_, -1); }
  int handle_ = -1;
};

/// A controller's state port on 127.0.0.1, used from the thread of the test.
class StatePeer {
 public:
  explicit StatePeer(int backlog = 8) { listen(0, backlog); }
  ~StatePeer() { stop_listening(); }

  std::uint16_t port() const { return port_; }
  PeerConnection accept();  ///< throws when nobody connects within kPatience
  bool somebody_connects_within(std::chrono::milliseconds time) const;
  void stop_listening();  ///< connections are refused from now on
  void listen_again() { listen(port_, 8); }

 private:
  void listen(std::uint16_t port, int backlog);
  int handle_ = -1;
  std::uint16_t port_ = 0;
};

/// Keeps what a link tells, and lets a test wait for it.
class LinkRecorder {
 public:
  RobotLinkEvents events();

  /// Waits until `condition` holds of this recorder (locked meanwhile); false after kPatience.
  template <class Condition>
  bool wait_for(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, condition);
  }
  bool wait_for_joints(std::size_t count) {
    return wait_for([&] { return joints.size() >= count; });
  }
  template <class Condition>
  bool wait_for_report(Condition condition) {
    return wait_for([&] { return std::ranges::any_of(reports, condition); });
  }
  /// Waits until that state has been told, now or before.
  bool wait_for_state(RobotLinkHealth::State state) {
    return wait_for_report([&](const RobotLinkHealth& told) { return told.state == state; });
  }
  template <class Condition>
  bool has_report(Condition condition) {
    const std::lock_guard lock(mutex_);
    return std::ranges::any_of(reports, condition);
  }
  std::size_t event_count() {
    const std::lock_guard lock(mutex_);
    return joints.size() + statuses.size() + reports.size();
  }

  // Guarded by mutex_: look at them inside wait_for(), or when the link has stopped.
  std::vector<ControllerJoints> joints;
  std::vector<ControllerStatus> statuses;
  std::vector<RobotLinkHealth> reports;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
};

/// Open file descriptors of this process.
std::size_t open_descriptors();

}  // namespace calibrd
