// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// A configuration from all its sources. Input: the TOML file, then lines "%env NAME=value" and
// "%set section.key=value". A configuration that was taken can be printed, and what was printed says the
// same.
#include "server/config/config_warnings.hpp"
#include "server/config/load_config.hpp"
#include "server/config/print_config.hpp"
#include "tests/core/robot/scratch_folder.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace calibrd;

ConfigSources sources_in(fuzz::Input input, const test::ScratchFolder& scratch) {
  ConfigSources sources;
  sources.file = scratch.write("fuzz.toml", input.until("\n%"));
  while (!input.empty()) {
    auto line = input.until("\n%");
    auto& list = line.starts_with("env ") ? sources.environment : sources.overrides;
    line.remove_prefix(std::min<std::size_t>(line.size(), 4));
    list.emplace_back(line);
  }
  return sources;
}

/// Without the comments that say where a value came from.
std::string printed(LoadedConfig loaded) {
  loaded.origins.clear();
  return config_as_toml(loaded);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const test::ScratchFolder scratch;
  const auto loaded = load_config(sources_in({data, size}, scratch));
  if (!loaded) {
    fuzz::require(!loaded.error().message().empty(), "an error says something");
    return 0;
  }
  config_warnings(loaded->config);
  const auto again = load_config({scratch.write("printed.toml", config_as_toml(*loaded)), {}, {}});
  if (!again) std::fprintf(stderr, "%s\n", again.error().message().c_str());
  fuzz::require(again.has_value(), "what is printed can be read");
  fuzz::require(printed(*again) == printed(*loaded), "what is printed says the same");
  return 0;
}
