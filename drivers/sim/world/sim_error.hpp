// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <system_error>

#include "core/base/result.hpp"

namespace calibrd::sim {

/// What can go wrong in the simulated cell. The table of messages is in sim_error.cpp.
enum class SimError {
  urdf_unreadable = 1,
  mesh_not_found,
  mesh_unreadable,
  no_joints,
  too_large,
  description_unreadable,
  description_invalid,
  no_free_posture,
  world_unwritable,
  world_in_use,
  world_unreadable,
  world_mismatch,
  cannot_listen,
  request_invalid,
  not_found,
  method_not_allowed,
  capture_unwritable,
  no_view_of_robot,
};

std::error_code make_error_code(SimError error);

inline Error sim_error(SimError code, std::string detail) {
  return {make_error_code(code), std::move(detail)};
}

}  // namespace calibrd::sim

template <>
struct std::is_error_code_enum<calibrd::sim::SimError> : std::true_type {};
