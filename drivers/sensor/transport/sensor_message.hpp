// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "drivers/sensor/transport/sensor_error.hpp"

namespace calibrd {

/// Messages from calibrd-sensor to calibrd, one datagram each: a kind byte, then the fields in the order
/// below, integers little-endian, strings as a 16-bit length and that many bytes.

/// First message. Both sides must speak the same version.
inline constexpr std::uint32_t kSensorLinkVersion = 1;
struct SensorHello {
  std::uint32_t version = kSensorLinkVersion;
};

/// The streams are running in this mode.
struct SensorStreaming {
  std::string device;  ///< vendor, name and URI
  std::string notice;  ///< what differs from the settings; empty: nothing
  std::uint16_t width = 0, height = 0, fps = 0;
  std::uint32_t depth_unit_um = 0;
};

/// The child gives up; it ends after this.
struct SensorFailure {
  SensorError error = SensorError::crashed;
  std::string detail;
};

using SensorMessage = std::variant<SensorHello, SensorStreaming, SensorFailure>;

/// Longest datagram; longer strings are cut when encoded.
inline constexpr std::size_t kMaxSensorMessage = 8192;

std::vector<std::byte> encode(const SensorMessage& message);

/// Nothing when the bytes are no message of this version: unknown kind or error, too short or too long.
std::optional<SensorMessage> decode(std::span<const std::byte> bytes);

}  // namespace calibrd
