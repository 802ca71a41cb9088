// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <span>

#include "core/base/result.hpp"
#include "drivers/robot/simple_message/message.hpp"
#include "drivers/robot/simple_message/value_check.hpp"

namespace calibrd::simple_message {

/// Decodes one frame as the Framer cut it (length field included) and checks its values. `valid_fields` comes
/// back with its reserved bits cleared.
/// Errors: SimpleMessageError; breaks_stream() tells whether the connection is lost or only this message.
Result<Message> decode(std::span<const std::byte> frame, const WireFormat& format,
                       const ValueLimits& limits = {});

}  // namespace calibrd::simple_message
