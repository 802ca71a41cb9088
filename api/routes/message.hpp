// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "api/access/scope.hpp"

namespace calibrd::api {

/// An HTTP request as the routes see it: decoded, complete, without a socket.
struct Request {
  std::string method;  ///< "GET", "POST", …
  std::string path;    ///< percent-decoded, without the query
  std::map<std::string, std::string> query;
  std::map<std::string, std::string> headers;  ///< names in lower case
  std::string body;
  std::string request_id = {};   ///< of this request in logs and answers
  std::string caller = {};       ///< name of the token, "local" where none is asked for; empty: unknown
  Scope granted = Scope::admin;  ///< what the caller may do
  std::chrono::steady_clock::time_point came = std::chrono::steady_clock::now();

  /// The header's value, or an empty string.
  const std::string& header(const std::string& lower_case_name) const {
    static const std::string none;
    const auto found = headers.find(lower_case_name);
    return found == headers.end() ? none : found->second;
  }
};

/// A body without an end, written bit by bit. One thread at a time.
class BodyStream {
 public:
  virtual ~BodyStream() = default;
  /// What is to be written now; empty: nothing yet, ask again soon.
  virtual std::string next() = 0;
  /// How soon is soon.
  virtual std::chrono::milliseconds pause() const { return std::chrono::milliseconds(50); }
  /// next() may compute or wait: it is called on a worker.
  virtual bool is_slow() const { return false; }
  /// Nothing more comes.
  virtual bool has_ended() const { return false; }
};

struct Response {
  int status = 200;
  std::vector<std::pair<std::string, std::string>> headers;  ///< Content-Type included
  std::string body;
  std::shared_ptr<const std::string> shared_body = nullptr;  ///< instead of `body`: that of others, too
  /// The client would rather wait for another answer than have this one: ask again until there is one, for at
  /// most this long.
  std::chrono::milliseconds worth_waiting{0};
  std::shared_ptr<BodyStream> stream = nullptr;  ///< instead of `body`, until the client or the daemon ends
  int route = -1;  ///< place in Router::routes() of what has answered; -1: none of them

  /// What is sent, where there is no stream.
  const std::string& text() const { return shared_body ? *shared_body : body; }
};

/// Splits "/path?a=1&b" and decodes it; nothing when it cannot be decoded.
std::optional<std::pair<std::string, std::map<std::string, std::string>>> parse_target(
    std::string_view target);

}  // namespace calibrd::api
