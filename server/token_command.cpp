// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/token_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>

#include "server/security/security_error.hpp"
#include "server/security/token_file.hpp"
#include "server/serve_command.hpp"

namespace calibrd {
namespace {

constexpr int kUnusable = 2;

int refuse(const Error& error) {
  std::cerr << "calibrd: " << error.message() << '\n';
  return kUnusable;
}

Result<std::filesystem::path> tokens_file(const TokenOptions& options) {
  if (!options.tokens_file.empty()) return std::filesystem::absolute(options.tokens_file);
  const auto loaded = load_config(sources_of({options.config_file, options.overrides}));
  if (!loaded) return loaded.error();
  if (loaded->config.server.tokens_file.empty()) return Error{SecurityError::no_tokens_file, {}};
  return loaded->config.server.tokens_file;
}

int create(const std::filesystem::path& file, const TokenOptions& options) {
  const auto token = create_token(file, options.name, *api::scope_named(options.scope));
  if (!token) return refuse(token.error());
  std::cout << *token << '\n';
  std::cerr << "This is the only time the token is shown. Clients send it as: Authorization: Bearer TOKEN\n";
  return 0;
}

int list(const std::filesystem::path& file) {
  const auto entries = read_tokens(file);
  if (!entries) return refuse(entries.error());
  for (const auto& entry : *entries)
    std::cout << entry.name << '\t' << api::name_of(entry.scope) << '\t' << entry.created << '\n';
  return 0;
}

int revoke(const std::filesystem::path& file, const TokenOptions& options) {
  const auto status = revoke_token(file, options.name);
  if (!status) return refuse(status.error());
  std::cerr << "Revoked. A running daemon refuses it within a second.\n";
  return 0;
}

CLI::App& add_action(CLI::App& command, TokenOptions& options, const char* name, const char* what) {
  auto* action = command.add_subcommand(name, what);
  action->callback([&options, name] { options.action = name; });
  action->add_option("--config", options.config_file, "Configuration file (TOML)")->type_name("FILE");
  action->add_option("--set", options.overrides, "Set one key of the configuration")
      ->type_name("SECTION.KEY=VALUE")
      ->allow_extra_args(false);
  action->add_option("--tokens-file", options.tokens_file, "Instead of server.tokens_file")
      ->type_name("FILE");
  return *action;
}

}  // namespace

void add_token_options(CLI::App& command, TokenOptions& options) {
  command.require_subcommand(1);
  auto& making = add_action(command, options, "create", "Make a token and print it, this once");
  making.add_option("name", options.name, "Who will have it: what the audit log calls them")->required();
  making.add_option("--scope", options.scope, "What it allows; each includes those before it")
      ->check(CLI::IsMember({"read", "calibrate", "admin"}))
      ->capture_default_str();
  add_action(command, options, "list", "List name, scope and time of creation of each");
  auto& revoking = add_action(command, options, "revoke", "Make a token worthless");
  revoking.add_option("name", options.name, "Whose")->required();
}

int run_token(const TokenOptions& options) {
  const auto file = tokens_file(options);
  if (!file) return refuse(file.error());
  if (options.action == "create") return create(*file, options);
  if (options.action == "list") return list(*file);
  return revoke(*file, options);
}

}  // namespace calibrd
