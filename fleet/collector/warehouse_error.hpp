// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <system_error>

namespace calibrd::fleet {

enum class WarehouseError {
  no_connection = 1,
  cannot_migrate,
  newer_schema,
  cannot_store,
  out_of_resources,
  unfit
};

std::error_code make_error_code(WarehouseError code);

}  // namespace calibrd::fleet

template <>
struct std::is_error_code_enum<calibrd::fleet::WarehouseError> : std::true_type {};
