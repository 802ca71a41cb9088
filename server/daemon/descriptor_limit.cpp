// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/descriptor_limit.hpp"

#include <sys/resource.h>

#include <algorithm>

namespace calibrd {
namespace {

/// Sensors, database, robot, meshes while they are read, refused connections that are being told so.
constexpr rlim_t kOthers = 512;

}  // namespace

int make_room_for_connections(int connections) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return connections;
  const rlim_t wanted = static_cast<rlim_t>(connections) + kOthers;
  if (limit.rlim_cur < wanted) {
    const rlimit raised{std::min(wanted, limit.rlim_max), limit.rlim_max};
    if (::setrlimit(RLIMIT_NOFILE, &raised) == 0) limit = raised;
  }
  if (limit.rlim_cur >= wanted) return connections;
  return limit.rlim_cur > kOthers ? static_cast<int>(limit.rlim_cur - kOthers) : 1;
}

}  // namespace calibrd
