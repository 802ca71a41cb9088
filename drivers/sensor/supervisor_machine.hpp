// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "drivers/sensor/sensor_settings.hpp"
#include "drivers/sensor/transport/sensor_message.hpp"

namespace calibrd {

/// How a process ended.
struct ProcessEnd {
  bool by_signal = false;
  int value = 0;  ///< signal number or exit status
};

/// What the ring says about the child.
struct Pulse {
  std::uint64_t heartbeat = 0;
  std::uint64_t frames = 0;
  bool operator==(const Pulse&) const = default;
};

/// Decides when a sensor's process is started, given up and started again. Does no I/O: its owner tells it
/// what happened and obeys next(). Not thread-safe.
class SupervisorMachine {
 public:
  using Time = std::chrono::steady_clock::time_point;
  enum class Order { wait, spawn, terminate, kill };

  explicit SupervisorMachine(const SensorTimeouts& timeouts) : timeouts_(timeouts) {}

  /// What to do now. `spawn` is answered by on_spawned() or on_spawn_failed(), the others by nothing.
  Order next(Time now);
  /// When next() has to be asked again if nothing happens before; nothing: never by itself.
  std::optional<Time> due() const;

  void on_spawned(Time now);
  void on_spawn_failed(Error error, Time now);
  void on_message(const SensorMessage& message, Time now);
  void on_pulse(const Pulse& pulse, Time now);
  void on_end(const ProcessEnd& end, Time now);
  /// No more starts; a running process is ended.
  void stop();

  /// Nothing runs and nothing will.
  bool is_finished() const { return phase_ == Phase::finished; }
  /// True from the first frame of a process to the first sign of its failure.
  bool is_streaming() const { return phase_ == Phase::streaming && has_frames_; }
  /// Why there are no frames; nothing while they flow, and before the first attempt has failed.
  const std::optional<Error>& failure() const { return failure_; }
  const std::optional<SensorStreaming>& stream() const { return stream_; }
  std::uint64_t restarts() const { return starts_ > 0 ? starts_ - 1 : 0; }

 private:
  enum class Phase { waiting, opening, streaming, ending, finished };

  std::optional<Order> overdue(Time now);
  Order give_up(Order order, Error error, Time now);
  Order end_process(Order order, Time now);
  void schedule_restart(Time now);
  void on_failure(const SensorFailure& failure, Time now);
  std::string device() const { return stream_ ? stream_->device : "opening the device"; }

  SensorTimeouts timeouts_;
  Phase phase_ = Phase::waiting;
  Time due_{};                   ///< waiting: of the next start; opening, ending: when patience ends
  Time beat_at_{}, frame_at_{};  ///< last change of the pulse
  Time streaming_since_{};
  Pulse pulse_;
  bool has_frames_ = false;
  bool was_told_ = false;  ///< this process has said why it fails
  bool is_over_ = false;   ///< a recording has ended: no restart
  bool is_stopping_ = false;
  int failures_ = 0;  ///< in a row
  std::uint64_t starts_ = 0;
  std::optional<Error> failure_;
  std::optional<SensorStreaming> stream_;
};

}  // namespace calibrd
