// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/access/scope.hpp"

namespace calibrd::api {

const char* name_of(Scope scope) {
  switch (scope) {
    case Scope::open:
      return "open";
    case Scope::read:
      return "read";
    case Scope::calibrate:
      return "calibrate";
    case Scope::admin:
      return "admin";
  }
  return "open";
}

std::optional<Scope> scope_named(std::string_view name) {
  for (const auto scope : {Scope::read, Scope::calibrate, Scope::admin})
    if (name == name_of(scope)) return scope;
  return std::nullopt;
}

}  // namespace calibrd::api
