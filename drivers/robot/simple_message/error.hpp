// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <system_error>

namespace calibrd::simple_message {

enum class SimpleMessageError {
  // The stream has no resync marker: after one of these the connection must be closed.
  length_out_of_range = 1,
  peer_is_little_endian,
  peer_is_big_endian,
  invalid_header,
  wrong_body_size,
  peer_sends_float64,
  peer_sends_float32,
  group_count_out_of_range,
  // The message is well formed, its values are not usable: drop it and read on.
  value_not_finite,
  value_out_of_range,
};

std::error_code make_error_code(SimpleMessageError error);

/// True when nothing that follows on the connection can be trusted; false when only this message must be
/// dropped.
bool breaks_stream(const std::error_code& code);

}  // namespace calibrd::simple_message

template <>
struct std::is_error_code_enum<calibrd::simple_message::SimpleMessageError> : std::true_type {};
