// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/operations/notify_socket.hpp"

namespace calibrd {

/// What a ServiceWatch looks at. Called on its thread; must be quick.
struct ServiceView {
  std::function<std::string()> status;  ///< one line for `systemctl status`
  /// Threads that have not gone on for so long.
  std::function<std::vector<std::string>(std::chrono::nanoseconds)> stalled;
  /// Hears of a thread that stalls, and of all going on again (an empty list).
  std::function<void(const std::vector<std::string>&)> on_stall;
};

/// Keeps the service manager informed from a thread of its own: the status as it changes, and the watchdog's
/// ping only while every thread that must go on does.
class ServiceWatch {
 public:
  /// `socket` may be null: then only on_stall is told. It must outlive the watch.
  ServiceWatch(const NotifySocket* socket, std::optional<std::chrono::microseconds> watchdog,
               ServiceView view);
  ~ServiceWatch();

 private:
  void run();
  void look();
  void send(const std::string& lines) const {
    if (socket_) socket_->send(lines);
  }

  const NotifySocket* const socket_;
  const bool pings_;
  const std::chrono::nanoseconds limit_, period_;
  const ServiceView view_;
  std::string told_;  // the thread's own, as the next
  std::vector<std::string> told_stalled_;
  std::mutex mutex_;
  std::condition_variable ending_;
  bool is_ending_ = false;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace calibrd
