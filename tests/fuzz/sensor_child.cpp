// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What the daemon and its sensor child say to each other: messages, arguments, the ring of frames in shared
// memory, of which the daemon trusts nothing. Input: which of them, then the bytes.
#include <algorithm>

#include "drivers/sensor/transport/frame_ring.hpp"
#include "drivers/sensor/transport/sensor_message.hpp"
#include "drivers/sensor/transport/stream_request.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace calibrd;

void read_message(std::span<const std::byte> bytes) {
  const auto message = decode(bytes.first(std::min(bytes.size(), kMaxSensorMessage)));
  if (!message) return;
  const auto again = encode(*message);
  const auto twice = decode(again);
  fuzz::require(twice && encode(*twice) == again, "what was sent again says the same");
}

void read_arguments(fuzz::Input input) {
  std::vector<std::string> arguments;
  while (!input.empty()) arguments.emplace_back(input.until("\n"));
  const auto request = request_from_arguments(arguments);
  if (!request) return fuzz::require(!request.error().message().empty(), "an error says something");
  fuzz::require(check(*request).has_value(), "what was taken is allowed");
  const auto again = request_from_arguments(to_arguments(*request));
  fuzz::require(again && to_arguments(*again) == to_arguments(*request), "what was given on says the same");
}

/// The memory as a child gone mad leaves it, with frames of its own between.
void read_ring(fuzz::Input input) {
  const RingGeometry geometry{5, 3, (input.byte() & 1U) != 0, 4};
  const auto fd = create_frame_ring(geometry);
  fuzz::require(fd.has_value(), "memory for a ring");
  auto reader = FrameRingReader::attach(fd->get(), geometry);
  auto writer = FrameRingWriter::attach(fd->get(), geometry);
  auto memory = SharedWords::map(fd->get(), geometry.total_words(), MapAccess::read_write);
  fuzz::require(reader && writer && memory, "a ring that can be read and written");
  const std::vector<std::uint16_t> pixels(geometry.pixels(), 7);
  while (!input.empty()) {
    const std::size_t word = input.byte() % geometry.total_words();
    if (input.byte() % 4 == 0) writer->publish({pixels, pixels, word, {}, 1000});
    memory->words()[word].store(input.byte() | std::uint64_t{input.byte()} << (8 * (input.byte() % 8)));
    const auto frame = reader->take();
    if (!frame) continue;
    fuzz::require(frame->depth.raw.size() == geometry.pixels(), "a value for each pixel");
    fuzz::require(frame->depth.scale_m == 1e-3 || frame->depth.scale_m == 1e-4, "a unit that is known");
    fuzz::require(!frame->image || geometry.with_image, "an image only where one is asked for");
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  switch (input.byte() % 3) {
    case 0:
      read_message(input.bytes());
      break;
    case 1:
      read_arguments(input);
      break;
    default:
      read_ring(input);
  }
  return 0;
}
