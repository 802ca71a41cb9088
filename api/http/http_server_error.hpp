// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <system_error>

namespace calibrd::api {

/// Why the HTTP server cannot listen. Error::detail names address and port.
enum class HttpServerError {
  bad_address = 1,
  port_in_use,
  not_allowed,
  cannot_listen,
  bad_certificate,
  bad_key,
  bad_client_ca
};

const std::error_category& http_server_category();
std::error_code make_error_code(HttpServerError code);

}  // namespace calibrd::api

template <>
struct std::is_error_code_enum<calibrd::api::HttpServerError> : std::true_type {};
