// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "drivers/robot/state_codec.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace calibrd::fuzz {

/// What the codec was told to deliver, and no more.
struct CodecPromise {
  std::size_t joint_count;
  double max_position;
};

using MakeCodec = std::unique_ptr<StateCodec> (*)(std::uint8_t variant);

/// Plays the rest of the input as what a controller sends, in pieces, into a codec and into a link machine
/// over another one: what is delivered keeps the promise, and how the bytes were cut changes nothing.
void drive_link(Input input, MakeCodec make_codec, std::uint8_t variant, const CodecPromise& promise);

}  // namespace calibrd::fuzz
