// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <optional>
#include <variant>

#include "drivers/sensor/sensor_settings.hpp"
#include "drivers/sensor/supervisor_machine.hpp"
#include "drivers/sensor/transport/file_descriptor.hpp"

namespace calibrd {

/// A running calibrd-sensor. Owned by the thread that started it, which must live as long: the system tells
/// the child of the death of that thread, not of the process. Not thread-safe.
class ChildProcess {
 public:
  /// Starts it with nothing open but standard in (empty), out and error, and the descriptors of
  /// child_protocol.hpp. Safe in a process with threads.
  static Result<ChildProcess> spawn(const SensorProcessSettings& settings, int ring_fd, int wake_fd);

  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  /// Kills what still runs, without waiting for more than a moment.
  ~ChildProcess();

  int end_fd() const { return end_.get(); }           ///< readable once the process has ended
  int message_fd() const { return messages_.get(); }  ///< readable when receive() has something

  void signal(int number);
  /// How it ended, once it has; leaves no zombie.
  std::optional<ProcessEnd> reap();

  struct Nothing {};
  struct Garbled {};
  std::variant<Nothing, Garbled, SensorMessage> receive();

 private:
  ChildProcess(pid_t id, FileDescriptor end, FileDescriptor messages);
  pid_t id_;
  FileDescriptor end_, messages_;
};

}  // namespace calibrd
