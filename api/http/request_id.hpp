// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace calibrd::api {

/// What a client sent as X-Request-Id, where it can stand in a header and in a log as it is: 1 to 64 of
/// [A-Za-z0-9._-]. Any other is no id.
bool is_request_id(std::string_view text);

/// Makes ids for requests that bring none: unlike those of other runs of the daemon, and of each other. One
/// thread.
class RequestIds {
 public:
  RequestIds();
  std::string next();

 private:
  std::string run_;
  std::uint64_t last_ = 0;
};

}  // namespace calibrd::api
