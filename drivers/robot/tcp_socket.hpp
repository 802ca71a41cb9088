// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/ip/tcp.hpp>
#include <cstddef>
#include <span>
#include <system_error>

#include "core/sensing/images.hpp"

/// What Asio leaves to the operating system's own calls: options and arrival times of a Linux TCP socket.
namespace calibrd {

/// Sets what a state stream wants: no delay, keep-alive (5 s, then 3 probes 1 s apart), an end to
/// unacknowledged data after 3 s, and arrival times by the kernel. Options the system does not know are left
/// out.
void tune_state_socket(boost::asio::ip::tcp::socket& socket);

/// True when a connection to this machine has met itself: the system may choose the very port it dials as its
/// own when nobody listens there (TCP's simultaneous open).
bool connected_to_itself(const boost::asio::ip::tcp::socket& socket);

struct StampedRead {
  std::size_t size = 0;     ///< bytes read; 0 without `error`: the peer closed
  Clock::time_point stamp;  ///< when the last of them arrived at this machine
  std::error_code error;    ///< operation_would_block: nothing there
};

/// Reads what is there, never waits. The stamp is the kernel's, so a busy process does not make data look
/// younger; where the kernel gives none it is the time of the call.
StampedRead read_stamped(boost::asio::ip::tcp::socket& socket, std::span<std::byte> buffer);

}  // namespace calibrd
