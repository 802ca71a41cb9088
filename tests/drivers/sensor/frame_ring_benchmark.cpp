// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Processor time of one 512x424 frame with infrared: the child putting it into the ring, the daemon taking it
// out, the memory for it included. Most of the latter is malloc returning that memory to the system after
// every frame; the second run shows the cost without.
#include <malloc.h>

#include <cstdio>
#include <ctime>
#include <vector>

#include "drivers/sensor/transport/frame_ring.hpp"

namespace {

using namespace calibrd;
constexpr int kFrames = 2000;

double thread_time_us() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_nsec) * 1e-3;
}

bool measure(const char* name) {
  const RingGeometry geometry{.width = 512, .height = 424, .with_image = true};
  const auto memory = create_frame_ring(geometry).value();
  auto writer = FrameRingWriter::attach(memory.get(), geometry).value();
  auto reader = FrameRingReader::attach(memory.get(), geometry).value();
  const std::vector<std::uint16_t> pixels(geometry.pixels(), 1234);

  double publishing_us = 0, taking_us = 0;
  int taken = 0;
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    const double start_us = thread_time_us();
    writer.publish({.depth = pixels, .image = pixels, .sequence = i, .stamp = Clock::now()});
    const double published_us = thread_time_us();
    if (const auto frame = reader.take()) taken += frame->depth.raw[i % geometry.pixels()] == 1234;
    taking_us += thread_time_us() - published_us;
    publishing_us += published_us - start_us;
  }
  std::printf("%s: child publishes in %.0f us, daemon takes in %.0f us\n", name, publishing_us / kFrames,
              taking_us / kFrames);
  return taken == kFrames;
}

}  // namespace

int main() {
  constexpr int kPlenty_bytes = 64 << 20;
  bool is_complete = measure("malloc as it is      ");
  ::mallopt(M_MMAP_THRESHOLD, kPlenty_bytes / 2);
  ::mallopt(M_TRIM_THRESHOLD, kPlenty_bytes);
  is_complete = measure("malloc keeping memory") && is_complete;
  return is_complete ? 0 : 1;
}
