// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/child/parent_link.hpp"

#include <sys/eventfd.h>
#include <sys/socket.h>

namespace calibrd {

void ParentLink::send(const SensorMessage& message) {
  const auto bytes = encode(message);
  ::send(message_fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

void ParentLink::wake() { ::eventfd_write(wake_fd_, 1); }

}  // namespace calibrd
