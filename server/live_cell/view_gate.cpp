// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/view_gate.hpp"

#include <algorithm>

namespace calibrd {
namespace {

/// One controller cycle: also with no settle time the robot must not move across the exposure.
constexpr auto kShortestWindow = std::chrono::milliseconds(25);

bool stood_still(const JointHistory& joints, const ViewGateSettings& settings, Clock::time_point begin,
                 Clock::time_point end) {
  const auto motion = joints.motion(begin, end, settings.stale_after);
  const std::chrono::duration<double> window = std::max<Clock::duration>(end - begin, kShortestWindow);
  return motion && *motion <= settings.still_speed_rad_s * window.count();
}

}  // namespace

const char* name_of(FrameVerdict verdict) {
  switch (verdict) {
    case FrameVerdict::usable:
      return "usable";
    case FrameVerdict::awaiting_joints:
      return "awaiting_joints";
    case FrameVerdict::no_joints:
      return "no_joints";
    case FrameVerdict::joints_stale:
      return "joints_stale";
    case FrameVerdict::moving:
      return "moving";
    case FrameVerdict::repeated:
      return "repeated";
    case FrameVerdict::out_of_order:
      return "out_of_order";
    case FrameVerdict::wrong_size:
      return "wrong_size";
  }
  return "no_joints";
}

const char* reason_of(FrameVerdict verdict) {
  switch (verdict) {
    case FrameVerdict::usable:
      return "";
    case FrameVerdict::awaiting_joints:
      return "the joints of the frame's time have not arrived yet";
    case FrameVerdict::no_joints:
      return "no joint positions have come from the controller; see link of /api/v1/robot";
    case FrameVerdict::joints_stale:
      return "the joint positions around the frame's time are stale; see link of /api/v1/robot";
    case FrameVerdict::moving:
      return "the robot moves, or has not been still for calibration.settle_time; let it hold still";
    case FrameVerdict::repeated:
      return "the sensor delivered the same frame again; restart it if this goes on";
    case FrameVerdict::out_of_order:
      return "the sensor delivered an older frame after a newer one; restart it if this goes on";
    case FrameVerdict::wrong_size:
      return "the frames have another size than configured; set width and height of the sensor to what it "
             "delivers";
  }
  return "";
}

FrameVerdict ViewGate::enter(std::uint64_t sequence, Clock::time_point stamp) {
  if (sequence_ && sequence == *sequence_) return FrameVerdict::repeated;
  if (sequence_ && (sequence < *sequence_ || stamp < stamp_)) return FrameVerdict::out_of_order;
  sequence_ = sequence;
  stamp_ = stamp;
  return FrameVerdict::usable;
}

FrameDecision ViewGate::judge(const JointHistory& joints, Clock::time_point now) const {
  const auto exposed = stamp_ - settings_.latency;
  const auto bracket = joints.around(exposed);
  if (!bracket) return {without_joints_around(joints, now), std::nullopt};
  if (bracket->after->stamp - bracket->before->stamp > settings_.stale_after)
    return {FrameVerdict::joints_stale, std::nullopt};
  auto positions = joints.positions_at(exposed);
  const bool still = stood_still(joints, settings_, exposed - settings_.settle_time, exposed);
  return {still ? FrameVerdict::usable : FrameVerdict::moving, std::move(positions)};
}

FrameVerdict ViewGate::without_joints_around(const JointHistory& joints, Clock::time_point now) const {
  const auto* newest = joints.newest();
  if (!newest) return FrameVerdict::no_joints;
  if (now - newest->stamp > settings_.stale_after) return FrameVerdict::joints_stale;
  const bool still_to_come = newest->stamp < stamp_ - settings_.latency;
  return still_to_come ? FrameVerdict::awaiting_joints : FrameVerdict::no_joints;
}

bool is_still(const JointHistory& joints, const ViewGateSettings& settings, Clock::time_point now) {
  const auto* newest = joints.newest();
  if (!newest || now - newest->stamp > settings.stale_after) return false;
  return stood_still(joints, settings, newest->stamp - settings.settle_time, newest->stamp);
}

}  // namespace calibrd
