// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What a Universal Robots controller sends: the replies of the handshake, then data. Input: variant, size of
// the pieces, then the bytes of the connection.
#include "drivers/robot/ur_rtde_codec.hpp"
#include "tests/fuzz/link_drive.hpp"

namespace {

using namespace calibrd;

std::unique_ptr<StateCodec> make_codec(std::uint8_t variant) {
  UrRtdeSettings settings;
  if (variant & 1U) settings.joint_ranges = {{-3, 3}, {-2, 2}};
  return std::make_unique<UrRtdeCodec>(settings);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  calibrd::fuzz::Input input(data, size);
  const std::uint8_t variant = input.byte();
  calibrd::fuzz::drive_link(input, make_codec, variant, {rtde::kJointCount, 100});
  return 0;
}
