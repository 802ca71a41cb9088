// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/healthcheck_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>

#include "server/config/load_config.hpp"
#include "server/operations/health_question.hpp"

namespace calibrd {
namespace {

constexpr int kUnhealthy = 1;

int unhealthy(const std::string& line) {
  std::cerr << "calibrd: " << line << '\n';
  return kUnhealthy;
}

HealthQuestion question_of(const ServerConfig& server, const HealthcheckOptions& options) {
  HealthQuestion question;
  question.address = server.address;
  question.port = static_cast<std::uint16_t>(server.port);
  question.path = options.ready ? "/readyz" : "/livez";
  question.within = std::chrono::milliseconds(static_cast<std::int64_t>(options.timeout_s * 1000));
  question.tls = !server.tls.certificate.empty();
  question.ca = options.ca;
  question.name = options.name;
  question.certificate = options.certificate;
  question.key = options.key;
  return question;
}

}  // namespace

void add_healthcheck_options(CLI::App& command, HealthcheckOptions& options) {
  command.add_option("--config", options.daemon.config_file, "Configuration file of the daemon (TOML)")
      ->type_name("FILE");
  command
      .add_option("--set", options.daemon.overrides, "Set one key of the configuration, as for the daemon")
      ->type_name("SECTION.KEY=VALUE")
      ->allow_extra_args(false);
  command.add_flag(
      "--ready", options.ready,
      "Ask whether robot, sensors and storage are there, too (not for what restarts the daemon)");
  command.add_option("--timeout", options.timeout_s, "For all of it")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.1, 600.0))
      ->capture_default_str();
  auto* ca = command.add_option("--ca", options.ca, "With TLS: authority of the daemon's certificate (PEM)");
  ca->type_name("FILE");
  command.add_option("--name", options.name, "What its certificate is for, if not the address")
      ->type_name("NAME")
      ->needs(ca);
  auto* certificate = command.add_option("--certificate", options.certificate,
                                         "Certificate to show, where server.tls.client_ca is set (PEM)");
  auto* key = command.add_option("--key", options.key, "Its key (PEM)");
  certificate->type_name("FILE")->needs(key);
  key->type_name("FILE")->needs(certificate);
}

int run_healthcheck(const HealthcheckOptions& options) {
  const auto loaded = load_config(sources_of(options.daemon));
  if (!loaded) return unhealthy(loaded.error().message());
  const auto& server = loaded->config.server;
  if (server.port == 0) return unhealthy("server.port is 0, any free one; name it: --set server.port=NUMBER");
  const auto answer = ask_health(question_of(server, options));
  if (!answer.healthy) return unhealthy(answer.line);
  std::cout << answer.line << '\n';
  return 0;
}

}  // namespace calibrd
