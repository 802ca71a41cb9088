// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/ssl/context.hpp>
#include <memory>

#include "api/http/tls_settings.hpp"
#include "core/base/result.hpp"

namespace calibrd::api {

/// What the connections of a server share to speak TLS. Those that are open keep theirs over a reload.
struct Tls {
  boost::asio::ssl::context context{boost::asio::ssl::context::tls_server};
};

/// What a server needs to speak TLS 1.2 and above; null where the settings name no certificate. Reads the
/// files now. Errors: HttpServerError::bad_certificate, bad_key, bad_client_ca, the detail naming the file
/// and OpenSSL's reason.
Result<std::shared_ptr<Tls>> make_tls(const TlsSettings& settings);

}  // namespace calibrd::api
