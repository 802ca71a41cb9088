// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cerrno>
#include <exception>
#include <iostream>
#include <string>
#include <system_error>

#include "api/metrics/metric_table.hpp"
#include "core/base/memory.hpp"
#include "server/calibrate_command.hpp"
#include "server/config/print_config.hpp"
#include "server/healthcheck_command.hpp"
#include "server/serve_command.hpp"
#include "server/support_bundle_command.hpp"
#include "server/token_command.hpp"

namespace {

constexpr int kUsage = 2;  // or input or output that cannot be used

/// A result that nobody received is no success: a full disk or a closed stdout is found when the last is
/// flushed.
int with_output_written(int status) {
  errno = 0;
  std::cout.flush();
  if (std::cout) return status;
  const auto why = errno == 0 ? std::string("unknown reason") : std::generic_category().message(errno);
  std::cerr << "calibrd: the output could not be written (" << why << "); check where stdout leads\n";
  return kUsage;
}

int print(const std::string& text) {
  std::cout << text;
  return 0;
}

int dispatch(int argc, char** argv) {
  CLI::App app{"calibrd keeps the pose of every fixed 3D sensor of a robot cell true.", "calibrd"};
  app.set_version_flag("--version", "calibrd " CALIBRD_VERSION);
  calibrd::ServeOptions serve_options;
  calibrd::add_serve_options(app, serve_options);
  auto* serve = app.add_subcommand("serve", "Run the daemon");
  calibrd::add_serve_options(*serve, serve_options);
  calibrd::CalibrateOptions calibrate_options;
  auto* calibrate = app.add_subcommand("calibrate", "Calibrate a recording and print the result as JSON");
  calibrd::add_calibrate_options(*calibrate, calibrate_options);
  calibrd::TokenOptions token_options;
  auto* token = app.add_subcommand("token", "Make, list and revoke the tokens of clients");
  calibrd::add_token_options(*token, token_options);
  auto* reference = app.add_subcommand("config-reference", "Print docs/configuration.md");
  calibrd::SupportBundleOptions bundle_options;
  auto* bundle =
      app.add_subcommand("support-bundle", "Save what a daemon tells of itself, for who is to help");
  calibrd::add_support_bundle_options(*bundle, bundle_options);
  calibrd::HealthcheckOptions health_options;
  auto* health = app.add_subcommand("healthcheck", "Ask a running daemon whether it is well: status 0 or 1");
  calibrd::add_healthcheck_options(*health, health_options);
  auto* metrics = app.add_subcommand("metrics-reference", "Print docs/metrics.md");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& failure) {
    return app.exit(failure) == 0 ? 0 : kUsage;
  }
  if (reference->parsed()) return print(calibrd::config_reference());
  if (metrics->parsed()) return print(calibrd::api::metrics_reference());
  if (health->parsed()) return calibrd::run_healthcheck(health_options);
  if (bundle->parsed()) return calibrd::run_support_bundle(bundle_options);
  if (calibrate->parsed()) return calibrd::run_calibrate(calibrate_options);
  if (token->parsed()) return calibrd::run_token(token_options);
  if (serve->parsed() || serve_options.check_config || serve_options.print_config)
    return calibrd::run_serve(serve_options);
  std::cerr << app.help();
  return kUsage;
}

}  // namespace

int main(int argc, char** argv) {
  calibrd::keep_freed_memory();
  try {
    return with_output_written(dispatch(argc, argv));
  } catch (const std::exception& failure) {
    std::cerr << "calibrd: unexpected failure: " << failure.what() << '\n';
    return 1;
  }
}
