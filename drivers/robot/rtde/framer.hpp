// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "core/base/result.hpp"

namespace calibrd::rtde {

constexpr std::size_t kHeaderBytes = 3;  ///< uint16 size of the whole package, uint8 type

/// Far above what is asked for (a data package has some 120 bytes) and what texts take (518 bytes).
constexpr std::size_t kMaxPackageBytes = 2048;

struct Package {
  char type = 0;                       ///< see packages.hpp
  std::span<const std::byte> payload;  ///< what follows the header
};

/// What Framer::take made of some bytes.
struct Taken {
  std::size_t consumed = 0;        ///< offer the rest again
  std::optional<Package> package;  ///< valid until the next take()
};

/// Cuts a byte stream into packages. The size is checked before anything of the payload is kept, so memory is
/// bounded by one package whatever the peer sends.
class Framer {
 public:
  /// Takes bytes up to the end of the package under way, in pieces of any size.
  /// Error: size_out_of_range; after it every take() fails until reset().
  Result<Taken> take(std::span<const std::byte> bytes);

  /// True between the first and the last byte of a package.
  bool inside_package() const { return size_ > 0 && !complete_; }

  /// Starts over, for a new connection.
  void reset();

 private:
  std::size_t append(std::span<const std::byte> bytes, std::size_t target_size);

  std::array<std::byte, kMaxPackageBytes> buffer_{};
  std::size_t size_ = 0;
  bool complete_ = false;
};

}  // namespace calibrd::rtde
