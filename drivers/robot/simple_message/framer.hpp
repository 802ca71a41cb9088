// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "core/base/result.hpp"
#include "drivers/robot/simple_message/wire.hpp"

namespace calibrd::simple_message {

constexpr std::size_t kLengthBytes = 4;
constexpr std::size_t kHeaderBytes = 16;  ///< length, message type, communication type, reply code
constexpr std::size_t kMinLength = 12;    ///< the length field counts what follows it
constexpr std::size_t kMaxLength = 1024;

/// What Framer::take made of some bytes.
struct Taken {
  std::size_t consumed = 0;                         ///< offer the rest again
  std::optional<std::span<const std::byte>> frame;  ///< length field included; valid until the next take()
};

/// Cuts a byte stream into frames. The length is checked before anything of the frame is kept, so memory is
/// bounded by one frame whatever the peer sends.
class Framer {
 public:
  explicit Framer(ByteOrder order) : order_(order) {}

  /// Takes bytes up to the end of the frame under way, in pieces of any size.
  /// Errors: length_out_of_range; on the first frame of a connection peer_is_little_endian or
  /// peer_is_big_endian when the length makes sense only in the other order. After an error every take()
  /// fails until reset().
  Result<Taken> take(std::span<const std::byte> bytes);

  /// True between the first and the last byte of a frame.
  bool inside_frame() const { return size_ > 0 && !complete_; }

  /// Starts over, for a new connection.
  void reset();

 private:
  std::size_t append(std::span<const std::byte> bytes, std::size_t target_size);
  Status check_length();

  ByteOrder order_;
  std::array<std::byte, kLengthBytes + kMaxLength> buffer_{};
  std::size_t size_ = 0;
  std::size_t frame_size_ = 0;  // 0 until the length is known
  bool complete_ = false;
  bool first_frame_ = true;
};

}  // namespace calibrd::simple_message
