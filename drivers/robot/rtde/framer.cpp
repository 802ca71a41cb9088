// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/rtde/framer.hpp"

#include <algorithm>
#include <string>

#include "drivers/robot/rtde/error.hpp"
#include "drivers/robot/rtde/wire.hpp"

namespace calibrd::rtde {

Result<Taken> Framer::take(std::span<const std::byte> bytes) {
  if (complete_) reset();
  Taken taken;
  taken.consumed = append(bytes, kHeaderBytes);
  if (size_ < kHeaderBytes) return taken;
  const std::size_t package_size = Reader(buffer_).u16();
  if (package_size < kHeaderBytes || package_size > kMaxPackageBytes)  // stays so, and fails again
    return Error{RtdeError::size_out_of_range, "package of " + std::to_string(package_size) + " bytes"};
  taken.consumed += append(bytes.subspan(taken.consumed), package_size);
  if (size_ < package_size) return taken;
  complete_ = true;
  taken.package = Package{static_cast<char>(buffer_[2]),
                          std::span(buffer_).subspan(kHeaderBytes, package_size - kHeaderBytes)};
  return taken;
}

void Framer::reset() {
  size_ = 0;
  complete_ = false;
}

std::size_t Framer::append(std::span<const std::byte> bytes, std::size_t target_size) {
  if (size_ >= target_size) return 0;
  const std::size_t count = std::min(bytes.size(), target_size - size_);
  std::copy_n(bytes.begin(), count, buffer_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += count;
  return count;
}

}  // namespace calibrd::rtde
