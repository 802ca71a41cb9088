// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace calibrd {

/// Tells the service manager how the process is, by the datagrams that sd_notify(3) documents; without
/// libsystemd. Safe to call from any thread.
class NotifySocket {
 public:
  /// `address`: a path, or "@name" for an abstract one, as $NOTIFY_SOCKET has it. Nothing for any other, or
  /// where no socket can be had.
  static std::optional<NotifySocket> open(std::string_view address);

  NotifySocket(NotifySocket&& other) noexcept;
  NotifySocket& operator=(NotifySocket&&) = delete;
  ~NotifySocket();

  /// Lines of NAME=VALUE. False: nobody has received them. Never waits.
  bool send(std::string_view lines) const;

 private:
  NotifySocket(int socket, std::string address) : socket_(socket), address_(std::move(address)) {}
  int socket_;
  std::string address_;  // of sockaddr_un::sun_path: a leading 0 byte for an abstract one
};

/// What the service manager wants to hear, from the environment it has started the process in.
struct NotifyOrders {
  std::string address;                                ///< empty: nobody listens
  std::optional<std::chrono::microseconds> watchdog;  ///< nothing: no watchdog, or that of another process
};

/// Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID, and takes them out of the environment, so that no
/// child takes them for its own. Before threads are started.
NotifyOrders take_notify_orders();

/// "RELOADING=1" with the time systemd wants beside it (Type=notify-reload).
std::string reloading_lines();

}  // namespace calibrd
