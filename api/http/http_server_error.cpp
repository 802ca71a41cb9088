// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/http_server_error.hpp"

#include <string>

namespace calibrd::api {
namespace {

const char* text(HttpServerError code) {
  switch (code) {
    case HttpServerError::bad_address:
      return "not an IP address of this machine; set server.address to one, or to 127.0.0.1 or 0.0.0.0";
    case HttpServerError::port_in_use:
      return "the port is in use by another process; end that one (`ss -ltnp` names it) or set another "
             "server.port";
    case HttpServerError::not_allowed:
      return "this user may not listen there; set server.port to 1024 or above";
    case HttpServerError::cannot_listen:
      return "the HTTP server cannot listen; check server.address and server.port";
    case HttpServerError::bad_certificate:
      return "the certificate cannot be used; server.tls.certificate must be a PEM file that the daemon's "
             "user can read";
    case HttpServerError::bad_key:
      return "the key cannot be used; server.tls.key must be a PEM file with the key of the certificate, and "
             "server.tls.key_password_file hold its password where it has one";
    case HttpServerError::bad_client_ca:
      return "the certificates of clients cannot be checked; server.tls.client_ca must be a PEM file with "
             "those of their authorities";
  }
  return "unknown HTTP server error";
}

class Category final : public std::error_category {
 public:
  const char* name() const noexcept override { return "http_server"; }
  std::string message(int code) const override { return text(static_cast<HttpServerError>(code)); }
};

}  // namespace

const std::error_category& http_server_category() {
  static const Category category;
  return category;
}

std::error_code make_error_code(HttpServerError code) {
  return {static_cast<int>(code), http_server_category()};
}

}  // namespace calibrd::api
