// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace calibrd::rtde {

using Bytes = std::vector<std::byte>;

/// Reads big-endian fields one after the other. Throws std::out_of_range past the end: sizes are checked
/// before.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::uint8_t u8() { return static_cast<std::uint8_t>(bits(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(bits(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(bits(4)); }
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  double real();
  std::string text(std::size_t count);
  std::size_t left() const { return bytes_.size(); }

 private:
  std::uint64_t bits(std::size_t count);
  std::span<const std::byte> bytes_;
};

/// Writes one package: header first, its size filled in by finish().
class Writer {
 public:
  explicit Writer(char type);

  Writer& u16(std::uint16_t value);
  Writer& real(double value);
  Writer& text(std::string_view text);
  Bytes finish();

 private:
  void bits(std::uint64_t value, std::size_t count);
  Bytes bytes_;
};

}  // namespace calibrd::rtde
