// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "api/access/authenticator.hpp"

namespace calibrd::api {

/// Which requests come in.
struct DoorSettings {
  std::vector<std::string> hosts;                ///< names of this daemon: see HostRules
  int rate_limit = 2000;                         ///< requests per second of one client; 0: any number
  int loopback_rate_limit = 20'000;              ///< of the clients on this machine, together
  std::shared_ptr<Authenticator> authenticator;  ///< null: no token is asked for
};

}  // namespace calibrd::api
