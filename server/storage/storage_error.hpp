// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <system_error>

namespace calibrd {

/// Why the calibration store cannot be used. Error::detail names the file and what SQLite said.
enum class StorageError {
  cannot_open = 1,
  in_use,
  not_a_store,
  newer_schema,
  cannot_read,
  cannot_write,
  full,
  read_only,
  damaged,
  out_of_memory,
  contradiction,  ///< a row that the schema refuses: trying again is of no use
};

const std::error_category& storage_category();
std::error_code make_error_code(StorageError code);

}  // namespace calibrd

template <>
struct std::is_error_code_enum<calibrd::StorageError> : std::true_type {};
