// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace calibrd::simple_message {

/// The order of every field on the wire: that of the controller's CPU. FS100: big; DX100, DX200, YRC1000:
/// little.
enum class ByteOrder { little, big };

/// The name of a byte order as the configuration spells it.
constexpr const char* name_of(ByteOrder order) { return order == ByteOrder::little ? "little" : "big"; }

/// How one controller writes its numbers. Integers always take 4 bytes.
struct WireFormat {
  ByteOrder byte_order = ByteOrder::big;
  std::size_t real_bytes = 4;  ///< 4 (all known controllers) or 8 (a build variant of the reference library)
};

/// Every message carries ten joints, unused ones as zero.
constexpr std::size_t kJointCount = 10;
using JointValues = std::array<double, kJointCount>;

/// Reads fields one after the other. Throws std::out_of_range past the end: sizes are checked before.
class ByteReader {
 public:
  ByteReader(std::span<const std::byte> bytes, WireFormat format) : bytes_(bytes), format_(format) {}

  std::int32_t read_int();
  double read_real();
  JointValues read_joints();
  std::span<const std::byte> rest() const { return bytes_; }

 private:
  std::uint64_t read_bits(std::size_t count);

  std::span<const std::byte> bytes_;
  WireFormat format_;
};

/// Writes fields one after the other.
class ByteWriter {
 public:
  explicit ByteWriter(WireFormat format) : format_(format) {}

  void write_int(std::int32_t value);
  void write_real(double value);  ///< rounded to the nearest float where reals take 4 bytes
  void write_joints(const JointValues& values);
  void write_bytes(std::span<const std::byte> bytes);
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  void write_bits(std::uint64_t bits, std::size_t count);

  std::vector<std::byte> bytes_;
  WireFormat format_;
};

}  // namespace calibrd::simple_message
