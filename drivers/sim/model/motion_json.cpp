// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "drivers/sim/model/postures.hpp"
#include "drivers/sim/model/settings_json.hpp"

namespace calibrd::sim {
namespace {

constexpr double kFastest_rad_s = 10, kLongestHold_s = 3600;

void read_postures(Fields& fields, const Robot& robot, std::vector<Joints>& postures) {
  std::vector<double> values;
  fields.numbers("postures_rad", values, 0);
  const std::size_t joints = robot.positions.size();
  if (values.size() % joints != 0 || values.size() / joints >= kMaxPostures)
    return fields.fail("postures_rad", "up to " + std::to_string(kMaxPostures - 1) + " lists of " +
                                           std::to_string(joints) + " joint positions");
  for (std::size_t at = 0; at < values.size(); at += joints) {
    Joints q{};
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(at), joints, q.begin());
    postures.push_back(q);
  }
}

Status jog(const MotionCommand& command, const Cell& cell, WorldState& state, std::int64_t now_ns) {
  const auto& positions = cell.robot.positions;
  const auto found = command.joint.empty()
                         ? positions.begin()
                         : std::find_if(positions.begin(), positions.end(), [&](const PositionRange& range) {
                             return range.name == command.joint;
                           });
  if (found == positions.end())
    return sim_error(SimError::request_invalid, "joint: no joint " + command.joint);
  const auto index = static_cast<std::size_t>(found - positions.begin());
  const Joints here = state.motion.positions_at(now_ns);
  Joints low = here, high = here;
  low[index] = 0.5 * found->lower;
  high[index] = 0.5 * found->upper;
  state.motion.visit(std::array{high, low}, Profile::constant_speed, command.speed_rad_s, 0.0, now_ns);
  return Done{};
}

Status run(const MotionCommand& command, const Cell& cell, WorldState& state, std::int64_t now_ns) {
  Random random(command.seed);
  const std::span objects(state.objects.data(), static_cast<std::size_t>(state.object_count));
  auto postures = random_postures(cell, objects, random, static_cast<std::size_t>(command.count),
                                  state.motion.positions_at(now_ns));
  if (!postures) return postures.error();
  state.motion.visit(*postures, Profile::minimum_jerk, command.speed_rad_s, command.hold_s, now_ns);
  return Done{};
}

}  // namespace

void read_motion(Fields& fields, const Robot& robot, MotionCommand& command) {
  int mode = static_cast<int>(command.mode);
  fields.choice("mode", {"run", "hold", "resume", "jog", "postures"}, mode);
  fields.whole("seed", command.seed);
  fields.integer("count", command.count, 2, kMaxPostures - 1);
  fields.number("speed_rad_s", command.speed_rad_s, 1e-4, kFastest_rad_s);
  fields.number("hold_s", command.hold_s, 0, kLongestHold_s);
  fields.text("joint", command.joint);
  read_postures(fields, robot, command.postures);
  command.mode = static_cast<MotionCommand::Mode>(mode);
  if (command.mode == MotionCommand::Mode::postures && command.postures.empty())
    fields.fail("postures_rad", "at least one posture");
}

Status apply_motion(const MotionCommand& command, const Cell& cell, WorldState& state, std::int64_t now_ns) {
  switch (command.mode) {
    case MotionCommand::Mode::run:
      return run(command, cell, state, now_ns);
    case MotionCommand::Mode::jog:
      return jog(command, cell, state, now_ns);
    case MotionCommand::Mode::postures:
      state.motion.visit(command.postures, Profile::minimum_jerk, command.speed_rad_s, command.hold_s,
                         now_ns);
      return Done{};
    case MotionCommand::Mode::hold:
    case MotionCommand::Mode::resume:
      state.motion.set_rate(command.mode == MotionCommand::Mode::hold ? 0 : 1, now_ns);
      return Done{};
  }
  return Done{};
}

}  // namespace calibrd::sim
