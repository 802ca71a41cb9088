// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "api/access/scope.hpp"

namespace calibrd::api {

/// Who asks, and what they may do.
struct Caller {
  std::string name;
  Scope scope = Scope::open;
};

/// Knows the tokens. Called by one thread at a time.
class Authenticator {
 public:
  virtual ~Authenticator() = default;
  /// Whose token it is; nothing when nobody has it. Takes as long whatever the token is.
  virtual std::optional<Caller> find(std::string_view token) = 0;
};

}  // namespace calibrd::api
