// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "drivers/sensor/depth_source.hpp"
#include "drivers/sensor/sensor_settings.hpp"
#include "drivers/sensor/transport/file_descriptor.hpp"
#include "drivers/sensor/transport/frame_ring.hpp"

namespace calibrd {

class ChildProcess;
class SupervisorMachine;

/// An OpenNI2 sensor, or a recording of one, in a process of its own that is started again whenever it fails.
/// One thread of its own looks after the process. next() has one caller at a time, which must be gone before
/// the destructor runs; health() may be called from any thread. The destructor ends the process, within a
/// second.
class SensorProcess : public DepthSource {
 public:
  /// Starts at once; whether a sensor is there shows in health(). Fails only for settings that cannot work
  /// (SensorError::invalid_settings) and for want of file descriptors (SensorError::system_refused).
  static Result<std::unique_ptr<SensorProcess>> start(SensorProcessSettings settings);
  ~SensorProcess() override;

  /// Sequence numbers go on across restarts of the process.
  std::optional<DepthFrame> next(std::chrono::milliseconds timeout) override;
  SensorHealth health() const override;

 private:
  SensorProcess(SensorProcessSettings settings, FileDescriptor wake, FileDescriptor stop);

  // The supervising thread.
  void supervise();
  void start_over(SupervisorMachine& machine, std::optional<ChildProcess>& child) const;
  void obey(SupervisorMachine& machine, std::optional<ChildProcess>& child, Clock::time_point now);
  void spawn(SupervisorMachine& machine, std::optional<ChildProcess>& child);
  void observe(SupervisorMachine& machine, std::optional<ChildProcess>& child, Clock::time_point now);
  void wait(const SupervisorMachine& machine, const std::optional<ChildProcess>& child) const;
  bool is_stop_requested() const;

  // The reader's thread.
  std::optional<DepthFrame> take();
  void number(DepthFrame& frame);

  const SensorProcessSettings settings_;
  const FileDescriptor wake_;  ///< eventfd the child raises for each frame
  const FileDescriptor stop_;  ///< eventfd the destructor raises

  mutable std::mutex mutex_;
  std::shared_ptr<FrameRingReader> ring_;  ///< of the newest child; guarded by mutex_
  SensorHealth health_;                    ///< guarded by mutex_

  std::shared_ptr<FrameRingReader> reading_;     ///< the reader's
  std::optional<std::uint64_t> child_sequence_;  ///< the reader's: last one of this ring
  std::optional<std::uint64_t> sequence_;        ///< the reader's: last one delivered
  std::atomic<std::uint64_t> frames_{0}, frames_lost_{0};

  std::thread thread_;
};

}  // namespace calibrd
