// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "api/service/reports.hpp"

namespace calibrd {

/// What goes into a support bundle: name in the archive, and content.
using BundleFiles = std::vector<std::pair<std::string, std::string>>;

/// The same TOML without what must not leave the machine: values of keys that are called token, secret,
/// password, passphrase, credential or key become "(left out)".
std::string without_secrets(const std::string& toml);

/// The last `bytes` of a file, from the beginning of a line; empty where there is none.
std::string end_of_file(const std::filesystem::path& file, std::size_t bytes);

/// A list of the newest files of a folder, newest first: size, time and name of each, one a line.
std::string list_of_files(const std::filesystem::path& folder, std::size_t most);

/// The newest views of calibrations, as captures/NAME, as long as they take no more than `bytes` together:
/// the one that somebody needs who is to repeat what went wrong.
BundleFiles newest_captures(const std::filesystem::path& folder, std::uintmax_t bytes = 64'000'000);

/// calibrd-support-TIME.tar, its files in a folder of that name, with a file that says what they are.
api::CaptureArchive bundle_of(const BundleFiles& files, api::SystemTime now);

}  // namespace calibrd
