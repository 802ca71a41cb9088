// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

namespace calibrd::api {

/// Files in PEM. Without a certificate there is no TLS.
struct TlsSettings {
  std::filesystem::path certificate;  ///< the server's, then those between it and the root
  std::filesystem::path key;
  std::filesystem::path key_password_file;  ///< empty: the key needs none
  std::filesystem::path client_ca;          ///< clients must show a certificate of it; empty: they need none
  bool is_on() const { return !certificate.empty(); }
  bool operator==(const TlsSettings&) const = default;
};

}  // namespace calibrd::api
