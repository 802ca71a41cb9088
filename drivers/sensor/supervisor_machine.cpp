// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/supervisor_machine.hpp"

#include <algorithm>
#include <cstring>

namespace calibrd {
namespace {

std::string describe(const ProcessEnd& end) {
  if (end.by_signal)
    return "calibrd-sensor was ended by signal " + std::to_string(end.value) + " (" + ::strsignal(end.value) +
           ")";
  return "calibrd-sensor ended with status " + std::to_string(end.value);
}

}  // namespace

SupervisorMachine::Order SupervisorMachine::next(Time now) {
  switch (phase_) {
    case Phase::waiting:
      if (is_stopping_) phase_ = Phase::finished;
      return !is_stopping_ && now >= due_ ? Order::spawn : Order::wait;
    case Phase::opening:
    case Phase::streaming:
      if (is_stopping_) return end_process(Order::terminate, now);
      return overdue(now).value_or(Order::wait);
    case Phase::ending:
      if (now < due_) return Order::wait;
      due_ = now + timeouts_.end;  // a process in an uninterruptible call survives even SIGKILL for a while
      return Order::kill;
    case Phase::finished:
      return Order::wait;
  }
  return Order::wait;
}

/// A driver that hangs does not hear SIGTERM; one that is only silent does, and then closes its device
/// properly.
std::optional<SupervisorMachine::Order> SupervisorMachine::overdue(Time now) {
  if (phase_ == Phase::opening) {
    if (now < due_) return std::nullopt;
    return give_up(Order::kill, sensor_error(SensorError::hung, "opening the device"), now);
  }
  if (now >= beat_at_ + timeouts_.heartbeat)
    return give_up(Order::kill, sensor_error(SensorError::hung, device()), now);
  if (now >= frame_at_ + timeouts_.silence)
    return give_up(Order::terminate, sensor_error(SensorError::silent, device()), now);
  return std::nullopt;
}

SupervisorMachine::Order SupervisorMachine::give_up(Order order, Error error, Time now) {
  failure_ = std::move(error);
  was_told_ = true;
  return end_process(order, now);
}

SupervisorMachine::Order SupervisorMachine::end_process(Order order, Time now) {
  phase_ = Phase::ending;
  due_ = now + timeouts_.end;
  return order;
}

std::optional<SupervisorMachine::Time> SupervisorMachine::due() const {
  if (phase_ == Phase::finished) return std::nullopt;
  if (phase_ != Phase::streaming) return due_;
  return std::min(beat_at_ + timeouts_.heartbeat, frame_at_ + timeouts_.silence);
}

void SupervisorMachine::on_spawned(Time now) {
  ++starts_;
  phase_ = Phase::opening;
  due_ = now + timeouts_.open;
  pulse_ = {};
  has_frames_ = was_told_ = false;
  stream_.reset();
}

void SupervisorMachine::on_spawn_failed(Error error, Time now) {
  failure_ = std::move(error);
  schedule_restart(now);
}

void SupervisorMachine::on_message(const SensorMessage& message, Time now) {
  if (const auto* hello = std::get_if<SensorHello>(&message)) {
    if (hello->version != kSensorLinkVersion) on_failure({SensorError::version_mismatch, ""}, now);
  } else if (const auto* failure = std::get_if<SensorFailure>(&message)) {
    on_failure(*failure, now);
  } else if (phase_ == Phase::opening || phase_ == Phase::streaming) {
    stream_ = std::get<SensorStreaming>(message);
    if (phase_ == Phase::opening) beat_at_ = frame_at_ = now;
    phase_ = Phase::streaming;
  }
}

/// The child ends by itself after this; it gets as long as one that was asked to.
void SupervisorMachine::on_failure(const SensorFailure& failure, Time now) {
  if (was_told_) return;  // what was found out first is the cause
  failure_ = sensor_error(failure.error, failure.detail);
  was_told_ = true;
  is_over_ = failure.error == SensorError::recording_ended;
  if (phase_ == Phase::opening || phase_ == Phase::streaming) end_process(Order::wait, now);
}

void SupervisorMachine::on_pulse(const Pulse& pulse, Time now) {
  if (phase_ == Phase::opening && pulse.frames > 0)
    phase_ = Phase::streaming;  // its message is still under way
  if (phase_ != Phase::streaming) return;
  if (pulse.heartbeat != pulse_.heartbeat) beat_at_ = now;
  if (pulse.frames != pulse_.frames) {
    frame_at_ = now;
    if (!has_frames_) streaming_since_ = now;
    has_frames_ = true;
    failure_.reset();
  }
  pulse_ = pulse;
  if (has_frames_ && now >= streaming_since_ + timeouts_.stable) failures_ = 0;
}

void SupervisorMachine::on_end(const ProcessEnd& end, Time now) {
  if (!was_told_)
    failure_ = sensor_error(end.by_signal ? SensorError::crashed : SensorError::ended_unasked, describe(end));
  if (is_over_ || is_stopping_)
    phase_ = Phase::finished;
  else
    schedule_restart(now);
}

void SupervisorMachine::stop() { is_stopping_ = true; }

void SupervisorMachine::schedule_restart(Time now) {
  constexpr int kMostDoublings = 20;
  const auto delay = timeouts_.restart_min * (1 << std::min(failures_, kMostDoublings));
  ++failures_;
  phase_ = Phase::waiting;
  due_ = now + std::min<std::chrono::milliseconds>(delay, timeouts_.restart_max);
}

}  // namespace calibrd
