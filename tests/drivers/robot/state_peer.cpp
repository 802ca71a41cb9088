// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/drivers/robot/state_peer.hpp"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace calibrd {
namespace {

constexpr int kPatienceMs = static_cast<int>(std::chrono::milliseconds(kPatience).count());

void require(bool ok, const char* what) {
  if (!ok) throw std::system_error(errno, std::system_category(), what);
}

bool readable_within(int handle, int milliseconds) {
  pollfd waiting{handle, POLLIN, 0};
  return ::poll(&waiting, 1, milliseconds) > 0;
}

}  // namespace

PeerConnection& PeerConnection::operator=(PeerConnection&& other) noexcept {
  close();
  handle_ = other.release();
  return *this;
}

void PeerConnection::send(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(handle_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0) return;  // the client has closed; the test sees that elsewhere
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
}

void PeerConnection::send_byte_by_byte(std::span<const std::byte> bytes) {
  const int on = 1;
  ::setsockopt(handle_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  for (std::size_t i = 0; i < bytes.size(); ++i) send(bytes.subspan(i, 1));
}

void PeerConnection::close() {
  if (handle_ >= 0) ::close(release());
}

void PeerConnection::reset() {
  const linger at_once{1, 0};
  ::setsockopt(handle_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  close();
}

std::vector<std::byte> PeerConnection::receive(std::size_t count) {
  std::vector<std::byte> received;
  while (received.size() < count) {
    if (!readable_within(handle_, kPatienceMs))
      throw std::runtime_error("the client neither sends nor closes");
    std::byte buffer[256];
    const ssize_t size = ::recv(handle_, buffer, std::min(sizeof buffer, count - received.size()), 0);
    if (size <= 0) break;
    received.insert(received.end(), buffer, buffer + size);
  }
  return received;
}

void StatePeer::listen(std::uint16_t port, int backlog) {
  handle_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  require(handle_ >= 0, "socket");
  const int on = 1;
  ::setsockopt(handle_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  require(::bind(handle_, reinterpret_cast<sockaddr*>(&address), size) == 0, "bind");
  require(::listen(handle_, backlog) == 0, "listen");
  require(::getsockname(handle_, reinterpret_cast<sockaddr*>(&address), &size) == 0, "getsockname");
  port_ = ntohs(address.sin_port);
}

PeerConnection StatePeer::accept() {
  if (!readable_within(handle_, kPatienceMs)) throw std::runtime_error("nobody connects");
  const int connection = ::accept4(handle_, nullptr, nullptr, SOCK_CLOEXEC);
  require(connection >= 0, "accept");
  return PeerConnection(connection);
}

bool StatePeer::somebody_connects_within(std::chrono::milliseconds time) const {
  return readable_within(handle_, static_cast<int>(time.count()));
}

void StatePeer::stop_listening() {
  if (handle_ >= 0) ::close(std::exchange(handle_, -1));
}

RobotLinkEvents LinkRecorder::events() {
  const auto record = [this](auto& where, const auto& what) {
    const std::lock_guard lock(mutex_);
    where.push_back(what);
    changed_.notify_all();
  };
  return {[=, this](const ControllerJoints& what) { record(joints, what); },
          [=, this](const ControllerStatus& what) { record(statuses, what); },
          [=, this](const RobotLinkHealth& what) { record(reports, what); }};
}

std::size_t open_descriptors() {
  const std::filesystem::directory_iterator open("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(open), end(open)));
}

}  // namespace calibrd
