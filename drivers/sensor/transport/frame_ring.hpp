// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/result.hpp"
#include "core/sensing/images.hpp"
#include "drivers/sensor/transport/shared_memory.hpp"

namespace calibrd {

/// What a ring holds: frames of one size, in a fixed number of slots.
struct RingGeometry {
  int width = 0;
  int height = 0;
  bool with_image = false;
  int slots = 4;

  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  std::size_t plane_words() const;
  std::size_t slot_words() const;
  std::size_t total_words() const;
};

/// Memory of a ring, empty, its header written. Made by the daemon, handed to the child.
Result<FileDescriptor> create_frame_ring(const RingGeometry& geometry);

/// One frame as the child hands it over: packed rows, as many pixels as the ring's geometry says.
struct FrameToPublish {
  std::span<const std::uint16_t> depth;
  std::span<const std::uint16_t> image;  ///< empty: none
  std::uint64_t sequence = 0;
  Clock::time_point stamp;
  std::uint32_t depth_unit_um = 1000;
};

/// The child's end. Never waits for the reader. One thread.
///
/// Each slot is a sequence lock: its state word is odd while frame n is written (2n+1) and 2n+2 when it is
/// whole. Data words are stored with release and loaded with acquire, so a reader that got any word of a
/// newer frame also sees the state word changed (Boehm 2012, "Can seqlocks get along with programming
/// language memory models?").
class FrameRingWriter {
 public:
  static Result<FrameRingWriter> attach(int fd, const RingGeometry& geometry);

  /// Tells the daemon that the child is alive.
  void beat();
  void publish(const FrameToPublish& frame);

 private:
  FrameRingWriter(SharedWords memory, const RingGeometry& geometry);
  SharedWords memory_;
  RingGeometry geometry_;
  std::uint64_t published_ = 0;
};

/// The daemon's end, over a read-only mapping. It trusts nothing in the memory: where things are follows from
/// its own geometry alone, and every value is checked before use. take() has one caller; the rest is safe
/// from any thread.
class FrameRingReader {
 public:
  static Result<FrameRingReader> attach(int fd, const RingGeometry& geometry);

  /// The next frame not taken yet, whole, or nothing. Frames come in order; who is too slow for the ring is
  /// moved on to its newest frame, which shows as a gap in the sequence.
  std::optional<DepthFrame> take();

  std::uint64_t heartbeat() const;
  std::uint64_t published() const;

 private:
  FrameRingReader(SharedWords memory, const RingGeometry& geometry);
  std::optional<DepthFrame> copy_out(std::uint64_t number) const;

  SharedWords memory_;
  RingGeometry geometry_;
  std::uint64_t next_ = 0;  ///< number of the next frame to take
};

}  // namespace calibrd
