// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/notify_socket.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <utility>

namespace calibrd {
namespace {

std::string take_variable(const char* name) {
  const char* const value = std::getenv(name);
  std::string text = value ? value : "";
  unsetenv(name);
  return text;
}

std::optional<std::int64_t> number_of(const std::string& text) {
  std::int64_t number = 0;
  const auto* const end = text.data() + text.size();
  const auto [rest, failure] = std::from_chars(text.data(), end, number);
  if (failure != std::errc() || rest != end || number <= 0) return std::nullopt;
  return number;
}

}  // namespace

std::optional<NotifySocket> NotifySocket::open(std::string_view address) {
  if (address.size() < 2 || address.size() >= sizeof(sockaddr_un::sun_path)) return std::nullopt;
  std::string path(address);
  if (path.front() == '@')
    path.front() = '\0';
  else if (path.front() != '/')
    return std::nullopt;
  const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket < 0) return std::nullopt;
  return NotifySocket(socket, std::move(path));
}

NotifySocket::NotifySocket(NotifySocket&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), address_(std::move(other.address_)) {}

NotifySocket::~NotifySocket() {
  if (socket_ >= 0) close(socket_);
}

bool NotifySocket::send(std::string_view lines) const {
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  std::copy(address_.begin(), address_.end(), to.sun_path);
  // An abstract name ends with the address, a path with its 0 byte.
  const auto end = address_.front() == '\0' ? address_.size() : address_.size() + 1;
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + end);
  const auto* const target = static_cast<const sockaddr*>(static_cast<const void*>(&to));
  return ::sendto(socket_, lines.data(), lines.size(), MSG_NOSIGNAL, target, size) ==
         static_cast<ssize_t>(lines.size());
}

NotifyOrders take_notify_orders() {
  NotifyOrders orders;
  orders.address = take_variable("NOTIFY_SOCKET");
  const auto interval = number_of(take_variable("WATCHDOG_USEC"));
  const auto process = number_of(take_variable("WATCHDOG_PID"));
  if (interval && (!process || *process == getpid())) orders.watchdog = std::chrono::microseconds(*interval);
  return orders;
}

std::string reloading_lines() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();  // CLOCK_MONOTONIC, as systemd wants
  return "RELOADING=1\nMONOTONIC_USEC=" +
         std::to_string(std::chrono::duration_cast<std::chrono::microseconds>(now).count());
}

}  // namespace calibrd
