// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/transport/frame_ring.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/time.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <thread>

#include "drivers/sensor/transport/sensor_error.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;

struct Ring {
  explicit Ring(const RingGeometry& g)
      : geometry(g),
        fd(create_frame_ring(g).value()),
        writer(FrameRingWriter::attach(fd.get(), g).value()),
        reader(FrameRingReader::attach(fd.get(), g).value()) {}

  /// A frame whose every pixel says which one it is.
  void publish(std::uint16_t number, bool with_image = false) {
    const std::vector<std::uint16_t> depth(geometry.pixels(), number);
    const std::vector<std::uint16_t> image(with_image ? geometry.pixels() : 0,
                                           static_cast<std::uint16_t>(~number));
    writer.publish(
        {.depth = depth, .image = image, .sequence = number, .stamp = Clock::time_point(5ns * number)});
  }

  RingGeometry geometry;
  FileDescriptor fd;
  FrameRingWriter writer;
  FrameRingReader reader;
};

bool is_all(const std::vector<std::uint16_t>& pixels, std::uint16_t value) {
  return std::all_of(pixels.begin(), pixels.end(), [&](auto pixel) { return pixel == value; });
}

TEST(FrameRing, HandsOverAFrame) {
  Ring ring({.width = 7, .height = 3, .with_image = true});  // 21 pixels: no whole number of words
  std::vector<std::uint16_t> depth(21), image(21);
  for (std::uint16_t i = 0; i < 21; ++i) {
    depth[i] = static_cast<std::uint16_t>(1000 + i);
    image[i] = static_cast<std::uint16_t>(65535 - i);
  }
  const Clock::time_point stamp(123456789ns);
  ring.writer.publish({.depth = depth, .image = image, .sequence = 42, .stamp = stamp, .depth_unit_um = 100});
  const auto frame = ring.reader.take();
  ASSERT_TRUE(frame && frame->image);
  EXPECT_EQ(frame->depth.raw, depth);
  EXPECT_EQ(frame->image->pixels, image);
  EXPECT_EQ(frame->depth.width, 7);
  EXPECT_EQ(frame->image->height, 3);
  EXPECT_EQ(frame->depth.scale_m, 0.0001);
  EXPECT_EQ(frame->sequence, 42u);
  EXPECT_EQ(frame->stamp, stamp);
}

TEST(FrameRing, HandsOverNoFrameTwice) {
  Ring ring({.width = 4, .height = 4});
  EXPECT_FALSE(ring.reader.take());
  ring.publish(1);
  EXPECT_TRUE(ring.reader.take());
  EXPECT_FALSE(ring.reader.take());
}

TEST(FrameRing, KeepsFramesWithAndWithoutImageApart) {
  Ring ring({.width = 4, .height = 4, .with_image = true});
  ring.publish(1, true);
  ring.publish(2, false);
  EXPECT_TRUE(ring.reader.take()->image);
  EXPECT_FALSE(ring.reader.take()->image);
}

TEST(FrameRing, DeliversInOrderWhatFits) {
  Ring ring({.width = 4, .height = 4, .slots = 4});
  for (std::uint16_t n = 1; n <= 3; ++n) ring.publish(n);
  for (std::uint16_t n = 1; n <= 3; ++n) EXPECT_EQ(ring.reader.take()->sequence, n);
}

TEST(FrameRing, MovesASlowReaderToTheNewestFrame) {
  Ring ring({.width = 4, .height = 4, .slots = 4});
  for (std::uint16_t n = 1; n <= 100; ++n) ring.publish(n);
  EXPECT_EQ(ring.reader.take()->sequence, 100u);
  EXPECT_FALSE(ring.reader.take());
}

TEST(FrameRing, ShowsTheHeartbeat) {
  Ring ring({.width = 4, .height = 4});
  const auto before = ring.reader.heartbeat();
  ring.writer.beat();
  EXPECT_NE(ring.reader.heartbeat(), before);
}

/// Publishes a frame from within a signal handler, so that it happens in the middle of the reader's copy
/// whatever the number of cores: publish() neither allocates nor locks.
struct Interruption {
  Ring* ring = nullptr;
  std::vector<std::uint16_t> even, odd;  // the pixels of frames of even and odd number
  std::uint64_t number = 0;

  void publish() {
    ++number;
    const auto& pixels = number % 2 == 0 ? even : odd;
    ring->writer.publish(
        {.depth = pixels, .image = pixels, .sequence = number, .stamp = Clock::time_point(1ns)});
  }
};
Interruption interruption;

TEST(FrameRing, NeverHandsOverATornFrame) {
  Ring ring({.width = 1280, .height = 1024, .with_image = true, .slots = 1});
  interruption = {&ring, std::vector<std::uint16_t>(ring.geometry.pixels(), 2000),
                  std::vector<std::uint16_t>(ring.geometry.pixels(), 1001)};
  std::signal(SIGALRM, [](int) { interruption.publish(); });
  int overtaken = 0;
  for (int round = 0; round < 100; ++round) {
    interruption.publish();
    const itimerval once{.it_interval = {}, .it_value = {.tv_sec = 0, .tv_usec = 20 * (1 + round % 50)}};
    ::setitimer(ITIMER_REAL, &once, nullptr);
    const auto frame = ring.reader.take();
    const itimerval never{};
    ::setitimer(ITIMER_REAL, &never, nullptr);
    if (!frame) {
      ++overtaken;
      continue;
    }
    const std::uint16_t expected = frame->sequence % 2 == 0 ? 2000 : 1001;
    ASSERT_TRUE(is_all(frame->depth.raw, expected)) << round;
    ASSERT_TRUE(frame->image && is_all(frame->image->pixels, expected)) << round;
  }
  std::signal(SIGALRM, SIG_DFL);
#ifndef __SANITIZE_THREAD__  // which holds signals back
  EXPECT_GT(overtaken, 0) << "no frame was overwritten while it was read: the test showed nothing";
#endif
}

TEST(FrameRing, NeverHandsOverATornFrameToAnotherThread) {
  Ring ring({.width = 256, .height = 128, .with_image = true, .slots = 2});
  constexpr std::uint16_t kFrames = 5000;
  std::atomic<bool> is_done = false;
  std::thread child([&] {
    for (std::uint16_t n = 1; n <= kFrames; ++n) ring.publish(n, true);
    is_done = true;
  });
  bool is_torn = false;
  std::uint64_t last = 0;
  while (!is_done || ring.reader.published() > last) {
    const auto frame = ring.reader.take();
    if (!frame) continue;
    is_torn = is_torn || frame->sequence <= last;
    last = frame->sequence;
    const auto number = static_cast<std::uint16_t>(last);
    is_torn = is_torn || !is_all(frame->depth.raw, number) || !frame->image ||
              !is_all(frame->image->pixels, static_cast<std::uint16_t>(~number));
  }
  child.join();
  EXPECT_FALSE(is_torn);
  EXPECT_EQ(last, kFrames);
}

TEST(FrameRing, CannotBeResizedOrWrittenByTheReader) {
  const auto fd = create_frame_ring({.width = 4, .height = 4}).value();
  EXPECT_NE(::ftruncate(fd.get(), 0), 0);
  EXPECT_NE(::ftruncate(fd.get(), 1 << 20), 0);
}

TEST(FrameRing, RefusesMemoryThatIsNoSuchRing) {
  const RingGeometry geometry{.width = 4, .height = 4};
  const auto other_size = create_frame_ring({.width = 8, .height = 4}).value();
  const auto transposed = create_frame_ring({.width = 2, .height = 8}).value();  // as many words
  const auto blank = create_shared_memory(geometry.total_words()).value();
  for (const int fd : {other_size.get(), transposed.get(), blank.get()}) {
    const auto reader = FrameRingReader::attach(fd, geometry);
    ASSERT_FALSE(reader);
    EXPECT_EQ(reader.error().code, SensorError::version_mismatch);
    EXPECT_FALSE(FrameRingWriter::attach(fd, geometry));
  }
}

TEST(FrameRing, RefusesMemoryWhoseSizeCanChange) {
  const RingGeometry geometry{.width = 4, .height = 4};
  const FileDescriptor unsealed(::memfd_create("unsealed", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  ASSERT_EQ(::ftruncate(unsealed.get(), static_cast<off_t>(geometry.total_words() * 8)), 0);
  EXPECT_FALSE(FrameRingReader::attach(unsealed.get(), geometry));
}

/// A child gone mad writes anything anywhere: the reader must not believe it, and must not crash.
TEST(FrameRing, SurvivesAnyContent) {
  const RingGeometry geometry{.width = 8, .height = 8, .with_image = true};
  const auto fd = create_frame_ring(geometry).value();
  auto reader = FrameRingReader::attach(fd.get(), geometry).value();
  auto memory = SharedWords::map(fd.get(), geometry.total_words(), MapAccess::read_write).value();
  std::uint64_t random = 88172645463325252u;
  for (int round = 0; round < 200; ++round) {
    for (auto& word : memory.words()) {
      random ^= random << 13, random ^= random >> 7, random ^= random << 17;
      word.store(round % 3 == 0 ? random : random % 4);
    }
    if (const auto frame = reader.take()) {
      EXPECT_EQ(frame->depth.raw.size(), geometry.pixels());
      EXPECT_TRUE(frame->depth.scale_m == 0.001 || frame->depth.scale_m == 0.0001);
    }
  }
}

}  // namespace
}  // namespace calibrd
