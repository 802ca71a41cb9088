// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/security/security_error.hpp"

#include <string>

namespace calibrd {
namespace {

const char* text(SecurityError code) {
  switch (code) {
    case SecurityError::tokens_unreadable:
      return "the file of tokens cannot be read; check server.tokens_file and that the daemon's user owns it";
    case SecurityError::tokens_open_to_others:
      return "others than its owner may read or change the file of tokens; run chmod 600 on it";
    case SecurityError::tokens_malformed:
      return "this is no file of tokens; make one with `calibrd token create`";
    case SecurityError::tokens_not_written:
      return "the file of tokens cannot be written; check its folder, its permissions and the disk";
    case SecurityError::no_tokens_file:
      return "no file of tokens is named; set server.tokens_file, or give --tokens-file";
    case SecurityError::bad_token_name:
      return "a token's name has 1 to 64 letters, digits, dots, - and _, and is not \"local\"; choose "
             "another";
    case SecurityError::token_exists:
      return "there is a token of this name; revoke it first, or choose another name";
    case SecurityError::no_such_token:
      return "no token has this name; `calibrd token list` shows them";
    case SecurityError::no_randomness:
      return "the system gave no random numbers; try again";
    case SecurityError::open_without_tokens:
      return "whoever reaches this address could use the daemon; set server.tokens_file and make tokens with "
             "`calibrd token create`, or set server.tls.client_ca, or listen on 127.0.0.1, or, where every "
             "machine that reaches it is trusted, set server.allow_unauthenticated = true";
    case SecurityError::no_such_user:
      return "there is no such user; correct server.run_as, or make the user";
    case SecurityError::cannot_become:
      return "the daemon cannot go on as this user; start it as root, or remove server.run_as";
  }
  return "unknown error of security";
}

class Category final : public std::error_category {
 public:
  const char* name() const noexcept override { return "security"; }
  std::string message(int code) const override { return text(static_cast<SecurityError>(code)); }
};

}  // namespace

const std::error_category& security_category() {
  static const Category category;
  return category;
}

std::error_code make_error_code(SecurityError code) { return {static_cast<int>(code), security_category()}; }

}  // namespace calibrd
