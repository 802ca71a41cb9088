// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <system_error>

namespace calibrd {

/// Why the daemon's doors cannot be kept. Error::detail names the file, token or key.
enum class SecurityError {
  tokens_unreadable = 1,
  tokens_open_to_others,
  tokens_malformed,
  tokens_not_written,
  no_tokens_file,
  bad_token_name,
  token_exists,
  no_such_token,
  no_randomness,
  open_without_tokens,
  no_such_user,
  cannot_become,
};

const std::error_category& security_category();
std::error_code make_error_code(SecurityError code);

}  // namespace calibrd

template <>
struct std::is_error_code_enum<calibrd::SecurityError> : std::true_type {};
