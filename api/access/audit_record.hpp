// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace calibrd::api {

/// One request that was to change something, and what became of it.
struct AuditRecord {
  std::string who;      ///< name of the token; "local" where no token is asked for
  std::string address;  ///< of the client
  std::string request_id;
  std::string method;
  std::string path;
  int status = 0;
  std::string location;  ///< of what was made; empty: nothing was
};

}  // namespace calibrd::api
