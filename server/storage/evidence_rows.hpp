// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "api/service/reports.hpp"
#include "server/storage/sqlite.hpp"

namespace calibrd {

// Evidence into the database, and from it. Errors: StorageError.

Status insert_evidence(Database& database, const std::string& calibration_id, const api::Evidence& evidence);
/// Nothing for calibrations from before evidence was kept.
Result<std::optional<api::Evidence>> select_evidence(Database& database, const std::string& calibration_id);

}  // namespace calibrd
