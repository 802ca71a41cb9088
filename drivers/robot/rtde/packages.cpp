// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/rtde/packages.hpp"

#include <algorithm>

#include "drivers/robot/rtde/error.hpp"

namespace calibrd::rtde {
namespace {

Error wrong_size(char type, std::size_t size) {
  return {RtdeError::wrong_payload_size,
          std::string("RTDE package '") + type + "' with a payload of " + std::to_string(size) + " bytes"};
}

/// What the peer says goes into messages for people.
std::string printable(std::string text) {
  constexpr std::size_t kLongest = 120;
  std::ranges::replace_if(
      text, [](char c) { return c < ' ' || c > '~'; }, ' ');
  return text.substr(0, kLongest);
}

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    parts.push_back(printable(list.substr(begin, end - begin)));
    begin = end + 1;
  }
  return parts;
}

}  // namespace

Bytes ask_for_protocol(std::uint16_t version) { return Writer(kProtocolVersion).u16(version).finish(); }
Bytes ask_for_controller_version() { return Writer(kControllerVersion).finish(); }
Bytes ask_to_start() { return Writer(kStart).finish(); }

Bytes ask_for_outputs(int protocol, double frequency_hz, std::span<const std::string_view> variables) {
  Writer request(kSetupOutputs);
  if (protocol > 1) request.real(frequency_hz);
  for (std::size_t i = 0; i < variables.size(); ++i) request.text(i == 0 ? "" : ",").text(variables[i]);
  return request.finish();
}

Result<bool> read_accepted(std::span<const std::byte> payload) {
  if (payload.size() != 1) return wrong_size(kProtocolVersion, payload.size());
  return payload[0] != std::byte{0};
}

std::string ControllerVersion::text() const {
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(bugfix);
}

Result<ControllerVersion> read_controller_version(std::span<const std::byte> payload) {
  if (payload.size() != 16) return wrong_size(kControllerVersion, payload.size());
  Reader in(payload);
  return ControllerVersion{in.u32(), in.u32(), in.u32(), in.u32()};
}

Result<OutputSetup> read_output_setup(int protocol, std::span<const std::byte> payload) {
  if (payload.empty()) return wrong_size(kSetupOutputs, payload.size());
  Reader in(payload);
  OutputSetup setup;
  if (protocol > 1) setup.recipe = in.u8();
  setup.types = split(in.text(in.left()));
  return setup;
}

std::string read_text(int protocol, std::span<const std::byte> payload) {
  if (payload.empty()) return {};
  Reader in(payload);
  const std::size_t first = in.u8();  // protocol 2: the length of the text; 1: the kind of message
  if (protocol < 2) return printable(in.text(in.left()));
  if (first > in.left()) return {};
  return printable(in.text(first));
}

}  // namespace calibrd::rtde
