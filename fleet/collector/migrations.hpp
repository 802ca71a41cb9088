// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

namespace calibrd::fleet {

/// Steps from an empty schema to today's. How many a database has taken stands in its table calibrd_schema; a
/// change is one more step, and the steps before it stay as they are.
std::span<const char* const> migrations();

}  // namespace calibrd::fleet
