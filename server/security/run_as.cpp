// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/security/run_as.hpp"

#include <grp.h>
#include <pwd.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>

#include "server/security/security_error.hpp"

namespace calibrd {
namespace {

Error cannot(const std::string& user) {
  return {SecurityError::cannot_become, user + " (" + std::generic_category().message(errno) + ")"};
}

/// Whoever could come back has not left.
bool is_for_good(uid_t user) {
  uid_t real = 0, effective = 0, saved = 0;
  const bool is_known = ::getresuid(&real, &effective, &saved) == 0;
  return is_known && real == user && effective == user && saved == user && (user == 0 || ::setuid(0) != 0);
}

}  // namespace

Status become(const std::string& user) {
  const auto* entry = ::getpwnam(user.c_str());
  if (!entry) return Error{SecurityError::no_such_user, user};
  const uid_t id = entry->pw_uid;
  const gid_t group = entry->pw_gid;
  if (::geteuid() != id || ::getuid() != id) {
    // The groups first: afterwards there is no right to change them.
    if (::initgroups(user.c_str(), group) != 0 || ::setgid(group) != 0 || ::setuid(id) != 0)
      return cannot(user);
  }
  if (!is_for_good(id)) return cannot(user);
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return cannot(user);
  return Done{};
}

}  // namespace calibrd
