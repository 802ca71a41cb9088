// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace calibrd {

struct TokenOptions {
  std::string config_file;  ///< empty: /etc/calibrd/calibrd.toml where it exists
  std::vector<std::string> overrides;
  std::string tokens_file;  ///< empty: server.tokens_file of the configuration
  std::string name;
  std::string scope = "read";
  std::string action;  ///< "create", "list" or "revoke"
};

void add_token_options(CLI::App& command, TokenOptions& options);

/// Makes, lists or revokes the tokens of a daemon, which need not run. A new token is printed once and kept
/// nowhere. Exit status: 0 done, 2 it cannot be (the reason is on stderr).
int run_token(const TokenOptions& options);

}  // namespace calibrd
