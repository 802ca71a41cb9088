// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/rtde/wire.hpp"

#include <bit>
#include <stdexcept>
#include <utility>

namespace calibrd::rtde {

std::uint64_t Reader::bits(std::size_t count) {
  if (bytes_.size() < count) throw std::out_of_range("rtde: read past the end of a package");
  std::uint64_t value = 0;
  for (const std::byte byte : bytes_.first(count)) value = value << 8 | std::to_integer<std::uint64_t>(byte);
  bytes_ = bytes_.subspan(count);
  return value;
}

double Reader::real() { return std::bit_cast<double>(bits(8)); }

std::string Reader::text(std::size_t count) {
  if (bytes_.size() < count) throw std::out_of_range("rtde: text past the end of a package");
  std::string text;
  for (const std::byte byte : bytes_.first(count)) text += static_cast<char>(byte);
  bytes_ = bytes_.subspan(count);
  return text;
}

Writer::Writer(char type) {
  bits(0, 2);
  bits(static_cast<std::uint8_t>(type), 1);
}

Writer& Writer::u16(std::uint16_t value) {
  bits(value, 2);
  return *this;
}

Writer& Writer::real(double value) {
  bits(std::bit_cast<std::uint64_t>(value), 8);
  return *this;
}

Writer& Writer::text(std::string_view text) {
  for (const char c : text) bits(static_cast<std::uint8_t>(c), 1);
  return *this;
}

Bytes Writer::finish() {
  bytes_[0] = static_cast<std::byte>(bytes_.size() >> 8);
  bytes_[1] = static_cast<std::byte>(bytes_.size());
  return std::exchange(bytes_, {});
}

void Writer::bits(std::uint64_t value, std::size_t count) {
  for (std::size_t i = count; i-- > 0;) bytes_.push_back(static_cast<std::byte>(value >> (8 * i)));
}

}  // namespace calibrd::rtde
