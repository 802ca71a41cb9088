// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>

namespace calibrd {

/// A service manager: the receiving end of NOTIFY_SOCKET. `address` as the variable has it.
class NotifyPeer {
 public:
  explicit NotifyPeer(const std::string& address) : socket_(::socket(AF_UNIX, SOCK_DGRAM, 0)) {
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    std::memcpy(at.sun_path, address.data(), address.size());
    const bool is_abstract = address.front() == '@';
    if (is_abstract) at.sun_path[0] = '\0';
    const auto size = offsetof(sockaddr_un, sun_path) + address.size() + (is_abstract ? 0 : 1);
    if (bind(socket_, reinterpret_cast<sockaddr*>(&at), static_cast<socklen_t>(size)) != 0)
      throw std::runtime_error(address + ": " + std::strerror(errno));
  }
  ~NotifyPeer() { close(socket_); }

  /// The next datagram; empty when none comes within `ms`.
  std::string receive(int ms = 5000) const {
    const timeval patience{ms / 1000, 1000 * (ms % 1000)};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    std::array<char, 4096> bytes{};
    const auto size = recv(socket_, bytes.data(), bytes.size(), 0);
    return size < 0 ? std::string() : std::string(bytes.data(), static_cast<std::size_t>(size));
  }
  /// The next one that begins so.
  std::string receive_beginning(const std::string& begin) const {
    std::string text;
    do text = receive();
    while (!text.empty() && !text.starts_with(begin));
    return text;
  }

 private:
  int socket_;
};

}  // namespace calibrd
