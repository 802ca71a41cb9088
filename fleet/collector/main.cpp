// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>

#include "core/base/utc_text.hpp"
#include "fleet/collector/collector.hpp"
#include "fleet/messages/topics.hpp"

namespace {

using calibrd::fleet::CollectorSettings;

constexpr int kUnusable = 2, kPlainPort = 1883, kTlsPort = 8883;

volatile std::sig_atomic_t ending = 0;

void write_line(const std::string& line, bool is_well) {
  auto text = line;
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::cerr << calibrd::utc_text(std::chrono::system_clock::now(), calibrd::kUtcSeconds) << "Z "
            << (is_well ? "info: " : "warning: ") << text << std::endl;
}

/// Every option can be given by the environment: containers are configured so.
void add_options(CLI::App& app, CollectorSettings& settings) {
  auto& broker = settings.broker;
  broker.host = "127.0.0.1";
  broker.port = 0;
  broker.client_id = "calibrd-collector";
  settings.database = "dbname=calibrd";
  const auto option = [&app](const char* name, auto& value, const char* variable, const char* meaning) {
    app.add_option(name, value, meaning)->envname(std::string("CALIBRD_COLLECTOR_") + variable);
  };
  option("--broker", broker.host, "BROKER", "Name or address of the MQTT broker");
  option("--port", broker.port, "PORT", "Its port; 0: 1883, with --tls 8883");
  option("--prefix", settings.prefix, "PREFIX", "First level of every topic, as mqtt.prefix of the daemons");
  option("--client-id", broker.client_id, "CLIENT_ID",
         "Of a second collector at the same broker: another one");
  option("--username", broker.username, "USERNAME", "User at the broker");
  option("--password-file", broker.password_file, "PASSWORD_FILE",
         "File whose first line is the user's password");
  app.add_flag("--tls", broker.tls, "Speak TLS to the broker")->envname("CALIBRD_COLLECTOR_TLS");
  option("--ca", broker.ca, "CA",
         "PEM file: authorities of the broker's certificate; the system's without it");
  option("--certificate", broker.certificate, "CERTIFICATE", "PEM file: certificate to show to the broker");
  option("--key", broker.key, "KEY", "PEM file with its key");
  option("--database", settings.database, "DATABASE",
         "PostgreSQL, as libpq takes it: \"host=db dbname=calibrd user=collector "
         "passfile=/run/secrets/pgpass\"");
}

int collect(int argc, char** argv) {
  CLI::App app{"calibrd-collector puts the calibrations of all cells into PostgreSQL: docs/fleet.md.",
               "calibrd-collector"};
  app.set_version_flag("--version", "calibrd-collector " CALIBRD_VERSION);
  CollectorSettings settings;
  add_options(app, settings);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& failure) {
    return app.exit(failure) == 0 ? 0 : kUnusable;
  }
  if (settings.broker.port == 0) settings.broker.port = settings.broker.tls ? kTlsPort : kPlainPort;
  if (!calibrd::fleet::is_name(settings.prefix)) {
    std::cerr << "calibrd-collector: --prefix: letters, digits, '.', '_' and '-', at most 64\n";
    return kUnusable;
  }
  const auto& broker = settings.broker;
  if (!broker.tls && !(broker.ca.empty() && broker.certificate.empty() && broker.key.empty())) {
    std::cerr << "calibrd-collector: --ca, --certificate and --key are of no use without --tls: the password "
                 "would go in clear\n";
    return kUnusable;
  }
  if (const auto status = calibrd::fleet::MqttClient::check(broker); !status) {
    std::cerr << "calibrd-collector: " << status.error().message() << '\n';
    return kUnusable;
  }
  setenv("PGCONNECT_TIMEOUT", "5", 0);  // else a server that is switched off holds it for minutes
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { ending = 1; });
  calibrd::fleet::Collector collector(settings, write_line);
  const auto status = collector.run([] { return ending != 0; });
  if (status) return 0;
  std::cerr << "calibrd-collector: " << status.error().message() << '\n';
  return kUnusable;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return collect(argc, argv);
  } catch (const std::exception& failure) {
    std::cerr << "calibrd-collector: unexpected failure: " << failure.what() << '\n';
    return 1;
  }
}
