// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/simple_message/framer.hpp"

#include <algorithm>
#include <string>

#include "drivers/robot/simple_message/error.hpp"

namespace calibrd::simple_message {
namespace {

std::int32_t length_as(ByteOrder order, std::span<const std::byte> bytes) {
  return ByteReader(bytes.first(kLengthBytes), {order, 4}).read_int();
}

bool plausible(std::int32_t length) {
  return length >= static_cast<std::int32_t>(kMinLength) && length <= static_cast<std::int32_t>(kMaxLength);
}

Error wrong_order(ByteOrder configured) {
  const bool peer_is_little = configured == ByteOrder::big;
  const std::string peer = name_of(peer_is_little ? ByteOrder::little : ByteOrder::big);
  return {peer_is_little ? SimpleMessageError::peer_is_little_endian : SimpleMessageError::peer_is_big_endian,
          "peer sends " + peer + " endian, " + name_of(configured) + " is configured"};
}

}  // namespace

Result<Taken> Framer::take(std::span<const std::byte> bytes) {
  if (complete_) {
    complete_ = false;
    size_ = frame_size_ = 0;
  }
  Taken taken;
  if (frame_size_ == 0) {  // also after an error: the bad length stays and fails again
    taken.consumed = append(bytes, kLengthBytes);
    if (size_ < kLengthBytes) return taken;
    if (const Status checked = check_length(); !checked) return checked.error();
  }
  taken.consumed += append(bytes.subspan(taken.consumed), frame_size_);
  if (size_ == frame_size_) {
    complete_ = true;
    taken.frame = std::span<const std::byte>(buffer_.data(), size_);
  }
  return taken;
}

void Framer::reset() {
  size_ = frame_size_ = 0;
  complete_ = false;
  first_frame_ = true;
}

std::size_t Framer::append(std::span<const std::byte> bytes, std::size_t target_size) {
  const std::size_t count = std::min(bytes.size(), target_size - size_);
  std::copy_n(bytes.begin(), count, buffer_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += count;
  return count;
}

Status Framer::check_length() {
  const std::int32_t length = length_as(order_, buffer_);
  if (plausible(length)) {
    frame_size_ = kLengthBytes + static_cast<std::size_t>(length);
    first_frame_ = false;
    return Done{};
  }
  // The order is never guessed again later on: in a stream that was cut, any four bytes can look like a
  // length.
  const ByteOrder other = order_ == ByteOrder::little ? ByteOrder::big : ByteOrder::little;
  const bool other_fits = first_frame_ && plausible(length_as(other, buffer_));
  if (other_fits) return wrong_order(order_);
  return Error{SimpleMessageError::length_out_of_range, "length " + std::to_string(length)};
}

}  // namespace calibrd::simple_message
