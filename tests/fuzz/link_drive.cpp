// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/link_drive.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/robot/link_machine.hpp"

namespace calibrd::fuzz {
namespace {

using std::chrono::milliseconds;

void check(const ControllerJoints& joints, const CodecPromise& promise) {
  const auto usable = [&](double q) { return std::abs(q) <= promise.max_position; };  // NaN is not
  require(joints.positions_rad.size() == promise.joint_count, "as many joints as configured");
  require(std::ranges::all_of(joints.positions_rad, usable), "positions a joint can have");
  require(joints.velocities_rad.empty() || joints.velocities_rad.size() == promise.joint_count,
          "velocities of all joints, or of none");
}

struct Totals {
  std::uint64_t messages = 0, joint_messages = 0, rejected = 0, skipped = 0, other_group = 0;
  bool broken = false;
  bool operator==(const Totals&) const = default;
};

Totals decode_in_pieces(StateCodec& codec, std::span<const std::byte> bytes, std::size_t piece,
                        const CodecPromise& promise) {
  codec.begin();
  Totals totals;
  while (!bytes.empty() && !totals.broken) {
    const auto some = bytes.first(std::min(piece, bytes.size()));
    const CodecOutput output = codec.decode(some, Clock::time_point{});
    totals.messages += output.messages;
    totals.joint_messages += output.joint_messages;
    totals.rejected += output.rejected_values;
    totals.skipped += output.skipped;
    totals.other_group += output.other_group;
    totals.broken = output.broken.has_value();
    if (output.broken) require(!output.broken->message().empty(), "an error says something");
    if (output.joints) check(*output.joints, promise);
    bytes = bytes.subspan(some.size());
  }
  return totals;
}

/// Obeys the steps as the shell would, without a socket: every connection is made at once.
class Shell {
 public:
  Shell(LinkMachine& machine, const CodecPromise& promise) : machine_(machine), promise_(promise) {}

  void obey(const LinkSteps& steps, Clock::time_point now) {
    for (const auto& step : steps) {
      if (const auto* joints = std::get_if<link_step::DeliverJoints>(&step)) take(joints->joints, now);
      if (std::holds_alternative<link_step::Connect>(step)) wants_connection_ = true;
      if (std::holds_alternative<link_step::Close>(step)) wants_connection_ = false;
      if (const auto* timer = std::get_if<link_step::ArmTimer>(&step)) timer_ = timer->at;
    }
    if (std::exchange(wants_connection_, false)) obey(machine_.on_connected(now), now);
  }
  Clock::time_point timer() const { return timer_; }

 private:
  void take(const ControllerJoints& joints, Clock::time_point now) {
    check(joints, promise_);
    require(joints.stamp <= now, "no joints from the future");
    require(joints.sequence > sequence_, "the sequence counts up");
    sequence_ = joints.sequence;
  }

  LinkMachine& machine_;
  const CodecPromise& promise_;
  bool wants_connection_ = false;
  Clock::time_point timer_{};
  std::uint64_t sequence_ = 0;
};

void run_machine(std::unique_ptr<StateCodec> codec, std::span<const std::byte> bytes, std::size_t piece,
                 const CodecPromise& promise) {
  LinkMachine machine(std::move(codec), {});
  Shell shell(machine, promise);
  Clock::time_point now{std::chrono::hours(1)};
  shell.obey(machine.start(now), now);
  while (!bytes.empty()) {
    const auto some = bytes.first(std::min(piece, bytes.size()));
    bytes = bytes.subspan(some.size());
    now += milliseconds(some.size());
    shell.obey(machine.on_received({some, now - milliseconds(1), bytes.size() % 2 == 1}, now), now);
    if (machine.health().state == RobotLinkHealth::State::streaming)
      require(machine.health().reason.empty(), "a link that streams has nothing to complain of");
    if (shell.timer() <= now || bytes.size() % 7 == 0) {
      now = std::max(now, shell.timer());
      shell.obey(machine.on_tick(now), now);
    }
  }
  shell.obey(machine.on_closed({}, now), now);
  shell.obey(machine.stop(), now);
}

}  // namespace

void drive_link(Input input, MakeCodec make_codec, std::uint8_t variant, const CodecPromise& promise) {
  const std::size_t piece = 1 + input.byte();
  const auto bytes = input.bytes();
  const auto at_once = decode_in_pieces(*make_codec(variant), bytes, bytes.size(), promise);
  const auto in_pieces = decode_in_pieces(*make_codec(variant), bytes, piece, promise);
  require(at_once == in_pieces, "pieces of any size give the same messages");
  run_machine(make_codec(variant), bytes, piece, promise);
}

}  // namespace calibrd::fuzz
