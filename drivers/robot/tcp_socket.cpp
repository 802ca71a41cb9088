// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/tcp_socket.hpp"

#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <optional>

namespace calibrd {
namespace {

using std::chrono::nanoseconds;
using std::chrono::seconds;

void set_option(int socket, int level, int name, int value) {
  // A kernel without one of these options still carries the stream; silence is detected by time-outs as well.
  (void)::setsockopt(socket, level, name, &value, sizeof value);
}

nanoseconds since_epoch(const timespec& time) { return seconds(time.tv_sec) + nanoseconds(time.tv_nsec); }

std::optional<nanoseconds> arrival_of(msghdr& message) {
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part; part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec time{};
    std::memcpy(&time, CMSG_DATA(part), sizeof time);
    return since_epoch(time);
  }
  return std::nullopt;
}

/// The kernel stamps in wall-clock time: only the age is taken over, so setting the clock moves at most one
/// message.
Clock::time_point stamp_from(const std::optional<nanoseconds>& arrival) {
  const Clock::time_point now = Clock::now();
  if (!arrival) return now;
  timespec wall{};
  ::clock_gettime(CLOCK_REALTIME, &wall);
  const nanoseconds age = since_epoch(wall) - *arrival;
  return now - std::clamp<nanoseconds>(age, nanoseconds::zero(), seconds(10));
}

}  // namespace

void tune_state_socket(boost::asio::ip::tcp::socket& socket) {
  const int handle = socket.native_handle();
  set_option(handle, IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(handle, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(handle, IPPROTO_TCP, TCP_KEEPIDLE, 5);
  set_option(handle, IPPROTO_TCP, TCP_KEEPINTVL, 1);
  set_option(handle, IPPROTO_TCP, TCP_KEEPCNT, 3);
  set_option(handle, IPPROTO_TCP, TCP_USER_TIMEOUT, 3000);
  set_option(handle, SOL_SOCKET, SO_TIMESTAMPNS, 1);
}

bool connected_to_itself(const boost::asio::ip::tcp::socket& socket) {
  boost::system::error_code failed;
  const auto local = socket.local_endpoint(failed);
  if (failed) return false;
  const auto remote = socket.remote_endpoint(failed);
  return !failed && local == remote;
}

StampedRead read_stamped(boost::asio::ip::tcp::socket& socket, std::span<std::byte> buffer) {
  iovec target{buffer.data(), buffer.size()};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec))> control{};
  msghdr message{};
  message.msg_iov = &target;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();

  const ssize_t count = ::recvmsg(socket.native_handle(), &message, MSG_DONTWAIT);
  StampedRead read;
  if (count < 0) {
    read.error = errno == EINTR ? std::make_error_code(std::errc::operation_would_block)
                                : std::error_code(errno, std::system_category());
    return read;
  }
  read.size = static_cast<std::size_t>(count);
  read.stamp = stamp_from(arrival_of(message));
  return read;
}

}  // namespace calibrd
