// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/transport/frame_ring.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <algorithm>
#include <atomic>
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

TEST(FrameRing, NeverHandsOverATornFrame) {
  // One slot and large frames: most are overwritten while they are read, even on a single busy core.
  Ring ring({.width = 1280, .height = 1024, .with_image = true, .slots = 1});
  std::atomic<bool> is_enough = false;
  std::atomic<int> attempts = 0;
  std::thread child([&] {
    for (std::uint16_t n = 1; !is_enough; ++n) {
      ring.publish(n, true);
      // Now and then a frame stays long enough for one whole attempt.
      for (const int seen = attempts; n % 4 == 0 && attempts < seen + 2 && !is_enough;)
        std::this_thread::yield();
    }
  });
  int whole_frames = 0;
  bool is_torn = false;
  const auto deadline = Clock::now() + 5s;
  while (!is_torn && whole_frames < 100 && Clock::now() < deadline) {
    const auto frame = ring.reader.take();
    ++attempts;
    if (!frame) continue;
    ++whole_frames;
    const auto number = static_cast<std::uint16_t>(frame->sequence);
    is_torn = !is_all(frame->depth.raw, number) || !frame->image ||
              !is_all(frame->image->pixels, static_cast<std::uint16_t>(~number));
  }
  is_enough = true;
  child.join();
  EXPECT_FALSE(is_torn);
  EXPECT_GT(whole_frames, 0);
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
