// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <filesystem>
#include <string>

#include "drivers/sensor/transport/stream_request.hpp"

namespace calibrd {

/// When a sensor's process counts as failed, and how soon it is started again.
struct SensorTimeouts {
  /// From the start of the process to the streams running; drivers that load firmware take seconds.
  std::chrono::milliseconds open{15000};
  /// Longest time without a sign of life from a process whose streams run (it gives ten a second).
  std::chrono::milliseconds heartbeat{2000};
  /// Longest time without a frame.
  std::chrono::milliseconds silence{3000};
  /// From SIGTERM to SIGKILL.
  std::chrono::milliseconds end{400};
  /// Wait before the first restart; doubles up to restart_max, and is forgotten after `stable` of good
  /// frames.
  std::chrono::milliseconds restart_min{100};
  std::chrono::milliseconds restart_max{300};  ///< a sensor that is plugged in streams within a second
  std::chrono::milliseconds stable{10000};
};

/// One sensor, as the daemon's configuration describes it. Intrinsics are no part of it: the driver is not
/// asked.
struct SensorProcessSettings {
  std::string id;  ///< the sensor's name in messages
  StreamRequest stream;
  std::filesystem::path program;  ///< calibrd-sensor; empty: beside the running executable
  /// A directory holding libOpenNI2.so.0 and OpenNI2/Drivers/lib….so.0, used instead of the system's; empty:
  /// the system's.
  std::filesystem::path openni_directory;
  SensorTimeouts timeouts;
};

/// Refuses settings that cannot work, naming the key.
Status check(const SensorProcessSettings& settings);

}  // namespace calibrd
