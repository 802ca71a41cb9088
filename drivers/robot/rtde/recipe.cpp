// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/rtde/recipe.hpp"

#include "drivers/robot/rtde/error.hpp"
#include "drivers/robot/rtde/wire.hpp"

namespace calibrd::rtde {
namespace {

struct Description {
  std::string_view name, type;
  std::size_t bytes;
};

constexpr Description describe(Variable variable) {
  switch (variable) {
    case Variable::timestamp:
      return {"timestamp", "DOUBLE", 8};
    case Variable::actual_q:
      return {"actual_q", "VECTOR6D", 48};
    case Variable::actual_qd:
      return {"actual_qd", "VECTOR6D", 48};
    case Variable::robot_mode:
      return {"robot_mode", "INT32", 4};
    case Variable::safety_status_bits:
      break;
  }
  return {"safety_status_bits", "UINT32", 4};
}

void read_joints(Reader& in, std::array<double, kJointCount>& values) {
  for (double& value : values) value = in.real();
}

void read(Variable variable, Reader& in, RobotState& state) {
  switch (variable) {
    case Variable::timestamp:
      state.timestamp_s = in.real();
      break;
    case Variable::actual_q:
      read_joints(in, state.positions_rad);
      break;
    case Variable::actual_qd:
      read_joints(in, state.velocities_rad_s);
      break;
    case Variable::robot_mode:
      state.mode = in.i32();
      break;
    case Variable::safety_status_bits:
      state.safety_bits = in.u32();
      break;
  }
}

}  // namespace

std::string_view name_of(Variable variable) { return describe(variable).name; }

Status check_types(std::span<const Variable> recipe, const std::vector<std::string>& types) {
  if (types.size() != recipe.size())
    return Error{RtdeError::unexpected_package,
                 std::to_string(types.size()) + " types for " + std::to_string(recipe.size()) + " variables"};
  std::string missing;
  for (std::size_t i = 0; i < types.size(); ++i)
    if (types[i] == "NOT_FOUND") missing.append(missing.empty() ? "" : ", ").append(name_of(recipe[i]));
  if (!missing.empty()) return Error{RtdeError::variable_not_found, missing};
  for (std::size_t i = 0; i < types.size(); ++i) {
    const Description expected = describe(recipe[i]);
    if (types[i] != expected.type)
      return Error{RtdeError::variable_of_other_type,
                   std::string(expected.name) + " is " + types[i] + ", not " + std::string(expected.type)};
  }
  return Done{};
}

Result<RobotState> read_state(std::span<const Variable> recipe, std::span<const std::byte> payload) {
  std::size_t expected = 0;
  for (const Variable variable : recipe) expected += describe(variable).bytes;
  if (payload.size() != expected)
    return Error{RtdeError::wrong_payload_size, "data of " + std::to_string(payload.size()) + " bytes, " +
                                                    std::to_string(expected) + " expected"};
  Reader in(payload);
  RobotState state;
  for (const Variable variable : recipe) read(variable, in, state);
  return state;
}

}  // namespace calibrd::rtde
