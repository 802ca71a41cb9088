// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// What a Universal Robots controller sends, written down by hand: it shares nothing with the code under
/// test.
namespace calibrd::rtde_bytes {

using Bytes = std::vector<std::byte>;
using Joints = std::array<double, 6>;

inline Bytes hex(const std::string& digits) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    bytes.push_back(static_cast<std::byte>(std::stoi(digits.substr(i, 2), nullptr, 16)));
  return bytes;
}

inline Bytes operator+(Bytes left, const Bytes& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

inline Bytes text(const std::string& characters) {
  Bytes bytes;
  for (const char c : characters) bytes.push_back(static_cast<std::byte>(c));
  return bytes;
}

inline Bytes number(std::uint64_t value, std::size_t count) {
  Bytes bytes;
  for (std::size_t i = count; i-- > 0;) bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
  return bytes;
}

inline Bytes real(double value) { return number(std::bit_cast<std::uint64_t>(value), 8); }

inline Bytes package(char type, const Bytes& payload = {}) {
  return number(payload.size() + 3, 2) + text({type}) + payload;
}

inline Bytes accepted(char type, bool yes = true) { return package(type, number(yes ? 1 : 0, 1)); }

inline Bytes controller_version(std::uint32_t major = 5) {
  return package('v', number(major, 4) + number(11, 4) + number(1, 4) + number(0, 4));
}

constexpr const char* kTypes = "DOUBLE,VECTOR6D,VECTOR6D,INT32,UINT32";

inline Bytes outputs(int recipe, const std::string& types = kTypes) {
  return package('O', number(static_cast<std::uint64_t>(recipe), 1) + text(types));
}

inline Bytes outputs_of_protocol_1(const std::string& types = kTypes) { return package('O', text(types)); }

inline Bytes text_message(const std::string& what, const std::string& source = "ctl") {
  return package(
      'M', number(what.size(), 1) + text(what) + number(source.size(), 1) + text(source) + number(2, 1));
}

struct Data {
  double timestamp_s = 100;
  Joints positions{0.1, -0.2, 0.3, -0.4, 0.5, -0.6}, velocities{1, -1, 0.5, -0.5, 0.25, -0.25};
  std::int32_t mode = 7;        // running
  std::uint32_t safety = 0x01;  // normal
};

inline Bytes fields(const Data& data) {
  Bytes bytes = real(data.timestamp_s);
  for (const Joints& joints : {data.positions, data.velocities})
    for (const double value : joints) bytes = bytes + real(value);
  return bytes + number(static_cast<std::uint32_t>(data.mode), 4) + number(data.safety, 4);
}

inline Bytes data(const Data& values = {}, int recipe = 1) {
  return package('U', number(static_cast<std::uint64_t>(recipe), 1) + fields(values));
}

/// All a controller of protocol 2 answers up to the start.
inline Bytes handshake(int recipe = 1) {
  return accepted('V') + controller_version() + outputs(recipe) + accepted('S');
}

}  // namespace calibrd::rtde_bytes
