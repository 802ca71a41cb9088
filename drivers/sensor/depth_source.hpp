// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <string>

#include "core/sensing/images.hpp"

namespace calibrd {

/// How a sensor is doing, in words a person can act on.
struct SensorHealth {
  enum class State { starting, streaming, lost };
  State state = State::starting;
  std::string reason;             ///< why it is not streaming, and what to do; empty while it is
  std::uint64_t frames = 0;       ///< delivered since start
  std::uint64_t frames_lost = 0;  ///< gaps in the device's sequence, and frames the reader was too slow for
  std::uint64_t restarts = 0;     ///< of the child process
  std::string device;             ///< vendor, name and URI of what is open; empty while nothing is
  std::string notice;             ///< what is not as configured although it streams; empty: nothing
};

/// A stream of depth frames. next() has one reader; health() may be called from any thread.
class DepthSource {
 public:
  virtual ~DepthSource() = default;
  /// Next frame, or nothing when none came within `timeout`. Never an old frame twice.
  virtual std::optional<DepthFrame> next(std::chrono::milliseconds timeout) = 0;
  virtual SensorHealth health() const = 0;
};

}  // namespace calibrd
