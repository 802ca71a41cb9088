// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "drivers/sensor/transport/sensor_message.hpp"

namespace calibrd {

/// The child's way to tell the daemon something. Never waits: a daemon that does not listen loses messages,
/// not frames' timing.
class ParentLink {
 public:
  ParentLink(int message_fd, int wake_fd) : message_fd_(message_fd), wake_fd_(wake_fd) {}
  void send(const SensorMessage& message);
  /// Says that a frame is in the ring.
  void wake();

 private:
  int message_fd_;
  int wake_fd_;
};

}  // namespace calibrd
