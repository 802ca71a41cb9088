// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/view_gate.hpp"

#include <algorithm>
#include <cstring>

namespace calibrd {
namespace {

/// One controller cycle: also with no settle time the robot must not move across the exposure.
constexpr auto kShortestWindow = std::chrono::milliseconds(25);
constexpr double kOffsetSigmas = 3;
constexpr double kJitterSigmas = 4;  // of the largest of some intervals

bool stood_still(const JointHistory& joints, const ViewGateSettings& settings, Clock::time_point begin,
                 Clock::time_point end) {
  if (joints.freeze().said_in_motion(begin, end + kShortestWindow)) return false;
  const auto motion = joints.motion(begin, end, settings.stale_after);
  const std::chrono::duration<double> window = std::max<Clock::duration>(end - begin, kShortestWindow);
  return motion && *motion <= settings.still_speed_rad_s * window.count();
}

/// Joints that repeat to the last bit around a moment when the controller said that the robot moves: it may
/// be about to, or they are not read any more.
bool is_doubtful(const JointHistory& joints, Clock::time_point exposed) {
  const auto bracket = joints.around(exposed);
  constexpr auto kAround = 2 * kShortestWindow;
  return bracket->before->positions_rad == bracket->after->positions_rad &&
         joints.freeze().said_in_motion(exposed - kAround, exposed + kAround);
}

/// Of all pixels (FNV-1a over 64-bit words); nothing for a frame without any measurement, which may well look
/// like the one before.
std::optional<std::uint64_t> fingerprint(const DepthImage& depth) {
  constexpr std::size_t kPerWord = sizeof(std::uint64_t) / sizeof(std::uint16_t);
  std::uint64_t hash = 0xcbf29ce484222325, any = 0;
  for (std::size_t i = 0; i < depth.raw.size(); i += kPerWord) {
    std::uint64_t word = 0;
    std::memcpy(&word, &depth.raw[i], std::min(kPerWord, depth.raw.size() - i) * sizeof(std::uint16_t));
    hash = (hash ^ word) * 0x100000001b3;
    hash ^= hash >> 32;
    any |= word;
  }
  if (any == 0) return std::nullopt;
  return hash;
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
    case FrameVerdict::joints_frozen:
      return "joints_frozen";
    case FrameVerdict::timed:
      return "timed";
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
    case FrameVerdict::joints_frozen:
      return "the controller's status goes on, its joint positions do not: they stopped, or repeat while it "
             "says that the robot moves; look at the controller (robot.trust_in_motion, when it is mistaken)";
    case FrameVerdict::timed:
      return "";
  }
  return "";
}

FrameVerdict ViewGate::enter(std::uint64_t sequence, Clock::time_point stamp, const DepthImage* depth) {
  if (sequence_ && (sequence == *sequence_ || stamp == stamp_)) return FrameVerdict::repeated;
  if (sequence_ && (sequence < *sequence_ || stamp < stamp_)) return FrameVerdict::out_of_order;
  cadence_.add(sequence, stamp);
  sequence_ = sequence;
  stamp_ = stamp;
  if (!depth) return FrameVerdict::usable;
  const auto pixels = fingerprint(*depth);
  const bool same = pixels && pixels == pixels_;
  pixels_ = pixels;
  return same ? FrameVerdict::repeated : FrameVerdict::usable;
}

FrameDecision ViewGate::judge(const JointHistory& joints, Clock::time_point stamp,
                              Clock::time_point now) const {
  FrameDecision decision;
  decision.exposed = stamp - settings_.latency - (offset_ ? offset_->value : Clock::duration(0));
  const auto bracket = joints.around(decision.exposed);
  if (joints.freeze().is_frozen())
    decision.verdict = FrameVerdict::joints_frozen;
  else if (!bracket)
    decision.verdict = without_joints_around(joints, decision.exposed, now);
  else if (bracket->after->stamp - bracket->before->stamp > settings_.stale_after)
    decision.verdict = FrameVerdict::joints_stale;
  else
    decision.verdict = judge_motion(joints, decision, cadence_.delay_s(stamp), now);
  return decision;
}

/// Whether the robot stood from before the exposure until no message that was still to come could say
/// otherwise of the exposure.
FrameVerdict ViewGate::judge_stillness(const JointHistory& joints, Clock::time_point exposed,
                                       Clock::time_point now) const {
  if (!stood_still(joints, settings_, exposed - settings_.settle_time, exposed)) return FrameVerdict::moving;
  const Clock::duration known_to = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(kOffsetSigmas * (offset_ ? offset_->sigma_s : 0)));
  const auto until = exposed + (offset_ ? std::min(known_to, settings_.lateness) : settings_.lateness);
  if (joints.newest()->stamp < until) return without_joints_around(joints, until, now);
  return stood_still(joints, settings_, exposed, until) ? FrameVerdict::usable : FrameVerdict::moving;
}

/// With the joints of the frame's time at hand.
FrameVerdict ViewGate::judge_motion(const JointHistory& joints, FrameDecision& decision, double frame_delay_s,
                                    Clock::time_point now) const {
  if (is_doubtful(joints, decision.exposed)) return FrameVerdict::moving;
  decision.positions_rad = joints.positions_at(decision.exposed);
  const auto stillness = judge_stillness(joints, decision.exposed, now);
  if (stillness == FrameVerdict::usable) decision.timing_error_m = 0;
  if (stillness != FrameVerdict::moving) return stillness;
  // What single frames jitter by is in the offset's sigma already.
  if (offset_ && frame_delay_s < kJitterSigmas * offset_->sigma_s) frame_delay_s = 0;
  if (reach_ &&
      late_error_m(joints, *reach_, decision.exposed, frame_delay_s) > settings_.largest_late_error_m) {
    decision.positions_rad.reset();  // old joints under a new stamp
    return FrameVerdict::moving;
  }
  if (offset_ && reach_)
    decision.timing_error_m =
        calibrd::timing_error_m(joints, *reach_, decision.exposed, offset_->sigma_s, frame_delay_s);
  const bool known = decision.timing_error_m && *decision.timing_error_m <= settings_.largest_timing_error_m;
  return known && settings_.timed_views ? FrameVerdict::timed : FrameVerdict::moving;
}

FrameVerdict ViewGate::without_joints_around(const JointHistory& joints, Clock::time_point exposed,
                                             Clock::time_point now) const {
  const auto* newest = joints.newest();
  if (!newest) return FrameVerdict::no_joints;
  if (now - newest->stamp > settings_.stale_after) {
    const auto status = joints.freeze().newest_status();
    const bool status_lives = status && now - *status <= settings_.stale_after;
    return status_lives ? FrameVerdict::joints_frozen : FrameVerdict::joints_stale;
  }
  return newest->stamp < exposed ? FrameVerdict::awaiting_joints : FrameVerdict::no_joints;
}

bool is_still(const JointHistory& joints, const ViewGateSettings& settings, Clock::time_point now) {
  const auto* newest = joints.newest();
  if (!newest || now - newest->stamp > settings.stale_after) return false;
  return stood_still(joints, settings, newest->stamp - settings.settle_time, newest->stamp);
}

}  // namespace calibrd
