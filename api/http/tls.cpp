// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/tls.hpp"

#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <array>
#include <fstream>

#include "api/http/connection.hpp"
#include "api/http/http_server_error.hpp"

namespace calibrd::api {
namespace {

namespace ssl = boost::asio::ssl;
using ErrorCode = boost::system::error_code;

Error fault(HttpServerError why, const std::filesystem::path& file, const ErrorCode& failure) {
  return {why, file.string() + " (" + failure.message() + ")"};
}

/// The first line of a file: a password with the end of its line would be another one.
std::string first_line(const std::filesystem::path& file) {
  std::string line;
  std::ifstream stream(file);
  std::getline(stream, line);
  return line;
}

void set_protocol(ssl::context& context) {
  auto* handle = context.native_handle();
  SSL_CTX_set_min_proto_version(handle, TLS1_2_VERSION);
  SSL_CTX_set_options(handle, SSL_OP_NO_COMPRESSION | SSL_OP_NO_RENEGOTIATION |
                                  SSL_OP_CIPHER_SERVER_PREFERENCE | SSL_OP_NO_TICKET);
  // A session that goes on would skip the client's certificate, also when it is no longer accepted.
  SSL_CTX_set_session_cache_mode(handle, SSL_SESS_CACHE_OFF);
  SSL_CTX_set_num_tickets(handle, 0);
}

}  // namespace

Result<std::shared_ptr<Tls>> make_tls(const TlsSettings& settings) {
  if (!settings.is_on()) return std::shared_ptr<Tls>();
  auto tls = std::make_shared<Tls>();
  auto* context = &tls->context;
  set_protocol(*context);
  ErrorCode failure;
  context->use_certificate_chain_file(settings.certificate.string(), failure);
  if (failure) return fault(HttpServerError::bad_certificate, settings.certificate, failure);
  const auto password = settings.key_password_file.empty() ? "" : first_line(settings.key_password_file);
  // Always set: OpenSSL asks at the terminal otherwise.
  context->set_password_callback([password](std::size_t, auto) { return password; }, failure);
  context->use_private_key_file(settings.key.string(), ssl::context::pem, failure);
  if (failure) return fault(HttpServerError::bad_key, settings.key, failure);
  if (SSL_CTX_check_private_key(context->native_handle()) != 1)
    return Error{HttpServerError::bad_key, settings.key.string() + " (it is not that of the certificate)"};
  if (settings.client_ca.empty()) return tls;
  context->load_verify_file(settings.client_ca.string(), failure);
  if (failure) return fault(HttpServerError::bad_client_ca, settings.client_ca, failure);
  context->set_verify_mode(ssl::verify_peer | ssl::verify_fail_if_no_peer_cert, failure);
  return tls;
}

std::string Connection::client_name() {
  if (!tls_) return {};
  const std::unique_ptr<X509, decltype(&X509_free)> certificate(
      SSL_get1_peer_certificate(tls_->native_handle()), &X509_free);
  std::array<char, 65> name{};  // RFC 5280: 64 at most
  if (!certificate || X509_NAME_get_text_by_NID(X509_get_subject_name(certificate.get()), NID_commonName,
                                                name.data(), static_cast<int>(name.size())) <= 0)
    return {};
  for (char& c : name)
    if (c != 0 && (c < ' ' || c > '~')) c = '?';
  return name.data();
}

}  // namespace calibrd::api
