// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/simple_message/wire.hpp"

#include <bit>
#include <stdexcept>

namespace calibrd::simple_message {
namespace {

/// How far the byte at `index` of `count` is shifted in the value.
std::size_t shift_of(std::size_t index, std::size_t count, ByteOrder order) {
  return 8 * (order == ByteOrder::little ? index : count - 1 - index);
}

}  // namespace

std::uint64_t ByteReader::read_bits(std::size_t count) {
  if (bytes_.size() < count) throw std::out_of_range("simple_message: read past the end of a body");
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    bits |= std::to_integer<std::uint64_t>(bytes_[i]) << shift_of(i, count, format_.byte_order);
  }
  bytes_ = bytes_.subspan(count);
  return bits;
}

std::int32_t ByteReader::read_int() {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(read_bits(4)));
}

double ByteReader::read_real() {
  if (format_.real_bytes == 8) return std::bit_cast<double>(read_bits(8));
  return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(read_bits(4))));
}

JointValues ByteReader::read_joints() {
  JointValues values;
  for (double& value : values) value = read_real();
  return values;
}

void ByteWriter::write_bits(std::uint64_t bits, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    bytes_.push_back(static_cast<std::byte>(bits >> shift_of(i, count, format_.byte_order)));
  }
}

void ByteWriter::write_int(std::int32_t value) { write_bits(static_cast<std::uint32_t>(value), 4); }

void ByteWriter::write_real(double value) {
  if (format_.real_bytes == 8) {
    write_bits(std::bit_cast<std::uint64_t>(value), 8);
  } else {
    write_bits(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4);
  }
}

void ByteWriter::write_joints(const JointValues& values) {
  for (const double value : values) write_real(value);
}

void ByteWriter::write_bytes(std::span<const std::byte> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

}  // namespace calibrd::simple_message
