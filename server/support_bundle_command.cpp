// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/support_bundle_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "core/base/utc_text.hpp"
#include "server/config/load_config.hpp"
#include "server/config/print_config.hpp"
#include "server/operations/fetch.hpp"
#include "server/operations/support_bundle.hpp"
#include "server/storage/capture_folder.hpp"

namespace calibrd {
namespace {

constexpr int kUnusable = 2;
constexpr std::size_t kListed = 50;

/// Of a daemon that does not answer: what a person would look at first.
std::string bundle_without_daemon(const LoadedConfig& loaded, const std::string& why) {
  const auto& database = loaded.config.storage.path;
  BundleFiles files{{"version.txt", "calibrd " CALIBRD_VERSION "\n"},
                    {"daemon.txt", "The daemon did not answer: " + why + "\n"},
                    {"config.toml", without_secrets(config_as_toml(loaded))},
                    {"storage.txt", list_of_files(database.parent_path(), kListed)},
                    {"captures.txt", list_of_files(capture_folder_of(database), kListed)}};
  std::ranges::move(newest_captures(capture_folder_of(database)), std::back_inserter(files));
  return bundle_of(files, std::chrono::system_clock::now()).tar;
}

std::string default_name() {
  return "calibrd-support-" + utc_text(std::chrono::system_clock::now(), kUtcCompact) + ".tar";
}

std::string first_word_of(const std::string& file) {
  std::string word;
  std::ifstream(file) >> word;
  return word;
}

/// Readable by its owner alone: it tells much of the cell.
bool save(const std::string& file, const std::string& bytes) {
  std::ofstream stream(file, std::ios::binary);
  std::error_code ignored;
  using std::filesystem::perms;
  std::filesystem::permissions(file, perms::owner_read | perms::owner_write, ignored);
  stream << bytes;
  stream.close();
  return static_cast<bool>(stream);
}

}  // namespace

void add_support_bundle_options(CLI::App& command, SupportBundleOptions& options) {
  command.add_option("--config", options.daemon.config_file, "Configuration file of the daemon (TOML)")
      ->type_name("FILE");
  command
      .add_option("--set", options.daemon.overrides, "Set one key of the configuration, as for the daemon")
      ->type_name("SECTION.KEY=VALUE")
      ->allow_extra_args(false);
  command
      .add_option("--token-file", options.token_file,
                  "File with a token of scope admin, where tokens are asked for")
      ->type_name("FILE");
  command.add_option("--output", options.output, "File to write")->type_name("FILE");
}

int run_support_bundle(const SupportBundleOptions& options) {
  const auto loaded = load_config(sources_of(options.daemon));
  if (!loaded) {
    std::cerr << "calibrd: " << loaded.error().message() << '\n';
    return kUnusable;
  }
  const auto& server = loaded->config.server;
  const auto fetched = fetch(server.address, static_cast<std::uint16_t>(server.port),
                             "/api/v1/support_bundle", first_word_of(options.token_file));
  if (!fetched)
    std::cerr << "calibrd: the daemon does not answer (" << fetched.error().detail
              << "); the bundle holds what can be said without it. Add its log: journalctl -u calibrd\n";
  const auto file = options.output.empty() ? default_name() : options.output;
  if (!save(file, fetched ? *fetched : bundle_without_daemon(*loaded, fetched.error().detail))) {
    std::cerr << "calibrd: " << file << " could not be written (" << std::strerror(errno)
              << "); name another file with --output\n";
    return kUnusable;
  }
  std::cout << file << '\n';
  return 0;
}

}  // namespace calibrd
