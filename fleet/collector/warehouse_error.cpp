// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/collector/warehouse_error.hpp"

#include <string>

namespace calibrd::fleet {
namespace {

const char* text(WarehouseError code) {
  switch (code) {
    case WarehouseError::no_connection:
      return "PostgreSQL cannot be reached; check --database, the server and its pg_hba.conf";
    case WarehouseError::cannot_migrate:
      return "the tables cannot be made or brought up to date; the collector's role must own its schema";
    case WarehouseError::newer_schema:
      return "the tables were made by a newer calibrd-collector; run that version";
    case WarehouseError::cannot_store:
      return "PostgreSQL does not store; it is tried again until it does";
    case WarehouseError::out_of_resources:
      return "PostgreSQL has no room or takes nothing at present; look at its disk and log";
    case WarehouseError::unfit:
      return "PostgreSQL cannot take this document, however often it is tried";
  }
  return "unknown database error";
}

class Category final : public std::error_category {
 public:
  const char* name() const noexcept override { return "warehouse"; }
  std::string message(int code) const override { return text(static_cast<WarehouseError>(code)); }
};

}  // namespace

std::error_code make_error_code(WarehouseError code) {
  static const Category category;
  return {static_cast<int>(code), category};
}

}  // namespace calibrd::fleet
