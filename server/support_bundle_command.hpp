// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "server/serve_command.hpp"

namespace calibrd {

struct SupportBundleOptions {
  ServeOptions daemon;     ///< which one: its configuration
  std::string token_file;  ///< holds a token with the scope admin; empty: none is sent
  std::string output;      ///< file; empty: calibrd-support-TIME.tar in the current folder
};

void add_support_bundle_options(CLI::App& command, SupportBundleOptions& options);

/// Saves what a running daemon tells of itself; where none answers, what can be said without it. Prints the
/// name of the file. Exit status: 0 saved, 2 the configuration cannot be used or the file not written (the
/// reason is on stderr).
int run_support_bundle(const SupportBundleOptions& options);

}  // namespace calibrd
