// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

namespace calibrd {

/// When a frame was made, in the device's own terms. Neither value can be trusted to mean much: drivers leave
/// them zero, invent them, or start again.
struct Moment {
  int index = 0;
  std::uint64_t timestamp_us = 0;
};

/// Numbers depth frames: by the device's index while that counts up, so that gaps show, else one by one.
class FrameNumbering {
 public:
  /// Number of this frame (the first is 0), or nothing when it is the last one delivered again.
  std::optional<std::uint64_t> number(const Moment& moment);

 private:
  std::optional<Moment> last_;
  std::uint64_t number_ = 0;
};

}  // namespace calibrd
