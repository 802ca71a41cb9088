// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "drivers/robot/simple_message/message.hpp"

namespace calibrd::simple_message {

/// A frame the reference library serialised, and what it was made from.
struct GoodVector {
  std::string name;
  WireFormat format;
  Message message;
  std::vector<std::byte> bytes;
};

/// A frame no reader should fall for, in both byte orders.
struct BadVector {
  std::string name;
  std::vector<std::byte> little, big;
};

std::vector<GoodVector> good_vectors();
std::vector<BadVector> bad_vectors();

/// The first cycle of a live reference server: `name` is plain/feedback, plain/position, bswap/feedback or
/// bswap/position (bswap: big endian).
std::vector<std::byte> live_first_cycle(const std::string& name);

}  // namespace calibrd::simple_message
