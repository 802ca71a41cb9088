// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <system_error>

namespace calibrd::fleet {

enum class MqttError { no_memory = 1, bad_address, bad_tls_file, bad_password_file, not_sent };

std::error_code make_error_code(MqttError code);

}  // namespace calibrd::fleet

template <>
struct std::is_error_code_enum<calibrd::fleet::MqttError> : std::true_type {};
