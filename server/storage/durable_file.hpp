// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"
#include "server/storage/storage_error.hpp"

namespace calibrd {

// Files that outlive a power cut. Errors: StorageError::full, read_only, else cannot_write, naming the file.

/// Replaces a file as a whole, by way of FILE.new: whatever happens, it is the old one or the new one.
Status write_durably(const std::filesystem::path& file, std::string_view content);

/// Makes a folder and those above it, each known to the disk.
Status make_folders_durably(const std::filesystem::path& folder);

/// Makes the disk know which files are in the folder.
Status sync_folder(const std::filesystem::path& folder);

/// The names in a folder, sorted; none where it cannot be read. (std::filesystem's iterators end the program
/// where memory is short.)
std::vector<std::string> names_in(const std::filesystem::path& folder);

/// An errno as an error of storage; `why` where it says nothing more special.
Error file_error(int number, const std::filesystem::path& file,
                 StorageError why = StorageError::cannot_write);

}  // namespace calibrd
