// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/robot/rtde/wire.hpp"

/// The packages of RTDE that a reader needs. Requests are whole packages, replies are payloads (without the
/// header). Everything is big endian.
namespace calibrd::rtde {

constexpr char kProtocolVersion = 'V', kControllerVersion = 'v', kSetupOutputs = 'O', kStart = 'S',
               kPause = 'P', kText = 'M', kData = 'U';

Bytes ask_for_protocol(std::uint16_t version);
Bytes ask_for_controller_version();
/// What is to be sent, in this order. Protocol 1 has no frequency: the controller sends as fast as it can.
Bytes ask_for_outputs(int protocol, double frequency_hz, std::span<const std::string_view> variables);
Bytes ask_to_start();

/// The reply to ask_for_protocol and ask_to_start. Error: wrong_payload_size.
Result<bool> read_accepted(std::span<const std::byte> payload);

struct ControllerVersion {
  std::uint32_t major = 0, minor = 0, bugfix = 0, build = 0;
  std::string text() const;  ///< "5.11.1"
};

/// Error: wrong_payload_size.
Result<ControllerVersion> read_controller_version(std::span<const std::byte> payload);

struct OutputSetup {
  std::uint8_t recipe = 0;         ///< what data packages will begin with; protocol 2 only
  std::vector<std::string> types;  ///< one for each variable; NOT_FOUND where it is unknown
};

/// Error: wrong_payload_size.
Result<OutputSetup> read_output_setup(int protocol, std::span<const std::byte> payload);

/// A text message for people, in printable characters; empty when it is malformed.
std::string read_text(int protocol, std::span<const std::byte> payload);

}  // namespace calibrd::rtde
