// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/descriptor_limit.hpp"

#include <spdlog/spdlog.h>
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

int room_for_connections(int connections) {
  const int room = make_room_for_connections(connections);
  if (room < connections)
    spdlog::warn("server.max_connections: the limit of open files (ulimit -Hn) is enough for {} of {}", room,
                 connections);
  return room;
}

}  // namespace calibrd
