// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <signal.h>

#include <chrono>

namespace calibrd {

/// SIGTERM, SIGINT and SIGHUP (read the configuration again) as something to wait for. Make one before any
/// thread is started: every thread inherits its mask.
class EndSignal {
 public:
  EndSignal();

  /// Waits for one of the signals and returns its number.
  int wait() const;

  /// From now on the process ends within `patience`, in good order or not: nothing that hangs (a driver, a
  /// disk, a long computation) may hold up the end, and everything that has been stored is on the disk
  /// already.
  static void end_within(std::chrono::milliseconds patience);

 private:
  sigset_t signals_;
};

}  // namespace calibrd
