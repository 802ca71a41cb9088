// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sensor/transport/frame_ring.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "drivers/sensor/transport/sensor_error.hpp"

namespace calibrd {
namespace {

constexpr std::uint64_t kMagic = 0x31474e4952424c43;  // "CLBRING1"
constexpr std::size_t kPixelsPerWord = sizeof(std::uint64_t) / sizeof(std::uint16_t);
constexpr std::size_t kWordsPerCacheLine = 8;

// The ring's first words. Heartbeat and published count have a cache line each: both are polled.
constexpr std::size_t kHeartbeat = 8;
constexpr std::size_t kPublished = 16;
constexpr std::size_t kHeaderWords = 24;

// The first words of a slot.
enum SlotWord : std::size_t { kState, kSequence, kStampNs, kDepthUnitUm, kHasImage, kSlotHeaderWords = 8 };

std::array<std::uint64_t, 5> description(const RingGeometry& g) {
  return {kMagic, static_cast<std::uint64_t>(g.width), static_cast<std::uint64_t>(g.height),
          g.with_image ? 1u : 0u, static_cast<std::uint64_t>(g.slots)};
}

Status check_description(std::span<const SharedWord> words, const RingGeometry& geometry) {
  const auto expected = description(geometry);
  for (std::size_t i = 0; i < expected.size(); ++i)
    if (words[i].load(std::memory_order_acquire) != expected[i])
      return sensor_error(SensorError::version_mismatch, "header of the frame ring");
  return Done{};
}

void store_pixels(std::span<SharedWord> to, std::span<const std::uint16_t> pixels) {
  for (std::size_t i = 0, word = 0; i < pixels.size(); i += kPixelsPerWord, ++word) {
    std::uint64_t value = 0;
    std::memcpy(&value, &pixels[i], std::min(kPixelsPerWord, pixels.size() - i) * sizeof(std::uint16_t));
    to[word].store(value, std::memory_order_release);
  }
}

std::vector<std::uint16_t> load_pixels(std::span<const SharedWord> from, std::size_t count) {
  std::vector<std::uint16_t> pixels(count);
  std::uint16_t* to = pixels.data();
  const std::size_t whole = count / kPixelsPerWord;
  for (std::size_t word = 0; word < whole; ++word, to += kPixelsPerWord) {
    const std::uint64_t value = from[word].load(std::memory_order_acquire);
    std::memcpy(to, &value, sizeof(value));
  }
  if (const std::size_t rest = count % kPixelsPerWord; rest != 0) {
    const std::uint64_t value = from[whole].load(std::memory_order_acquire);
    std::memcpy(to, &value, rest * sizeof(std::uint16_t));
  }
  return pixels;
}

template <class Words>
auto slot_of(Words words, const RingGeometry& g, std::uint64_t number) {
  const std::size_t slot = static_cast<std::size_t>(number % static_cast<std::uint64_t>(g.slots));
  return words.subspan(kHeaderWords + slot * g.slot_words(), g.slot_words());
}

constexpr std::uint64_t writing(std::uint64_t number) { return 2 * number + 1; }
constexpr std::uint64_t whole(std::uint64_t number) { return 2 * number + 2; }

bool is_known_unit(std::uint64_t unit_um) { return unit_um == 1000 || unit_um == 100; }

}  // namespace

std::size_t RingGeometry::plane_words() const {
  const std::size_t words = (pixels() + kPixelsPerWord - 1) / kPixelsPerWord;
  return (words + kWordsPerCacheLine - 1) / kWordsPerCacheLine * kWordsPerCacheLine;
}

std::size_t RingGeometry::slot_words() const {
  return kSlotHeaderWords + plane_words() * (with_image ? 2 : 1);
}

std::size_t RingGeometry::total_words() const {
  return kHeaderWords + slot_words() * static_cast<std::size_t>(slots);
}

Result<FileDescriptor> create_frame_ring(const RingGeometry& geometry) {
  auto fd = create_shared_memory(geometry.total_words());
  if (!fd) return fd.error();
  auto memory = SharedWords::map(fd->get(), geometry.total_words(), MapAccess::read_write);
  if (!memory) return memory.error();
  const auto header = description(geometry);
  for (std::size_t i = 0; i < header.size(); ++i)
    memory->words()[i].store(header[i], std::memory_order_release);
  return fd;
}

FrameRingWriter::FrameRingWriter(SharedWords memory, const RingGeometry& geometry)
    : memory_(std::move(memory)), geometry_(geometry) {}

Result<FrameRingWriter> FrameRingWriter::attach(int fd, const RingGeometry& geometry) {
  auto memory = SharedWords::map(fd, geometry.total_words(), MapAccess::read_write);
  if (!memory) return memory.error();
  if (auto checked = check_description(std::as_const(*memory).words(), geometry); !checked)
    return checked.error();
  return FrameRingWriter(std::move(*memory), geometry);
}

void FrameRingWriter::beat() { memory_.words()[kHeartbeat].fetch_add(1, std::memory_order_relaxed); }

void FrameRingWriter::publish(const FrameToPublish& frame) {
  const auto slot = slot_of(memory_.words(), geometry_, published_);
  const auto put = [&](SlotWord word, std::uint64_t value) {
    slot[word].store(value, std::memory_order_release);
  };
  const auto plane = geometry_.plane_words();
  put(kState, writing(published_));
  put(kSequence, frame.sequence);
  put(kStampNs,
      static_cast<std::uint64_t>(
          std::chrono::duration_cast<std::chrono::nanoseconds>(frame.stamp.time_since_epoch()).count()));
  put(kDepthUnitUm, frame.depth_unit_um);
  put(kHasImage, frame.image.empty() ? 0 : 1);
  store_pixels(slot.subspan(kSlotHeaderWords, plane), frame.depth);
  if (!frame.image.empty()) store_pixels(slot.subspan(kSlotHeaderWords + plane, plane), frame.image);
  put(kState, whole(published_));
  ++published_;
  memory_.words()[kPublished].store(published_, std::memory_order_release);
}

FrameRingReader::FrameRingReader(SharedWords memory, const RingGeometry& geometry)
    : memory_(std::move(memory)), geometry_(geometry) {}

Result<FrameRingReader> FrameRingReader::attach(int fd, const RingGeometry& geometry) {
  auto memory = SharedWords::map(fd, geometry.total_words(), MapAccess::read);
  if (!memory) return memory.error();
  if (auto checked = check_description(std::as_const(*memory).words(), geometry); !checked)
    return checked.error();
  return FrameRingReader(std::move(*memory), geometry);
}

std::uint64_t FrameRingReader::heartbeat() const {
  return memory_.words()[kHeartbeat].load(std::memory_order_relaxed);
}

std::uint64_t FrameRingReader::published() const {
  return memory_.words()[kPublished].load(std::memory_order_acquire);
}

std::optional<DepthFrame> FrameRingReader::take() {
  for (int attempt = 0; attempt < geometry_.slots; ++attempt) {
    const std::uint64_t count = published();
    if (count <= next_) return std::nullopt;
    // One slot may be in the writer's hands, so only the others are there to be read.
    if (count - next_ >= static_cast<std::uint64_t>(geometry_.slots)) next_ = count - 1;
    if (auto frame = copy_out(next_++)) return frame;
  }
  return std::nullopt;
}

std::optional<DepthFrame> FrameRingReader::copy_out(std::uint64_t number) const {
  const auto slot = slot_of(memory_.words(), geometry_, number);
  const auto get = [&](SlotWord word) { return slot[word].load(std::memory_order_acquire); };
  if (get(kState) != whole(number)) return std::nullopt;

  DepthFrame frame;
  frame.sequence = get(kSequence);
  frame.stamp = Clock::time_point(std::chrono::nanoseconds(static_cast<std::int64_t>(get(kStampNs))));
  const std::uint64_t unit_um = get(kDepthUnitUm);
  const bool has_image = get(kHasImage) == 1 && geometry_.with_image;
  const auto plane = geometry_.plane_words();
  frame.depth = {geometry_.width, geometry_.height, static_cast<double>(unit_um) / 1e6,
                 load_pixels(slot.subspan(kSlotHeaderWords, plane), geometry_.pixels())};
  if (has_image)
    frame.image = GreyImage{geometry_.width, geometry_.height,
                            load_pixels(slot.subspan(kSlotHeaderWords + plane, plane), geometry_.pixels())};

  if (slot[kState].load(std::memory_order_relaxed) != whole(number))
    return std::nullopt;  // overwritten meanwhile
  if (!is_known_unit(unit_um)) return std::nullopt;
  return frame;
}

}  // namespace calibrd
