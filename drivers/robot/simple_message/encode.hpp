// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <vector>

#include "drivers/robot/simple_message/message.hpp"

namespace calibrd::simple_message {

/// The bytes of one message on the wire, length field included.
std::vector<std::byte> encode(const Message& message, const WireFormat& format);

}  // namespace calibrd::simple_message
