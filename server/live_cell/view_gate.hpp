// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/live_cell/joint_history.hpp"

namespace calibrd {

/// What becomes of a frame.
enum class FrameVerdict {
  usable,           ///< robot still, joints of the frame's time known: a view
  awaiting_joints,  ///< ask again: the joints after the frame's time have not come yet
  no_joints,
  joints_stale,
  moving,
  repeated,
  out_of_order,
  wrong_size  ///< not the size of the camera model
};
inline constexpr std::size_t kFrameVerdicts = 8;

/// Stable name for programs: "usable", "moving", …
const char* name_of(FrameVerdict verdict);
/// Why the frame is no view and what to do about it; empty for a usable one.
const char* reason_of(FrameVerdict verdict);

struct ViewGateSettings {
  Clock::duration stale_after = std::chrono::milliseconds(250);
  Clock::duration settle_time = std::chrono::milliseconds(300);
  Clock::duration latency{0};        ///< from exposure to the frame's stamp
  double still_speed_rad_s = 0.002;  ///< the robot is still while no joint is faster
};

struct FrameDecision {
  FrameVerdict verdict = FrameVerdict::no_joints;
  std::optional<std::vector<double>>
      positions_rad;  ///< at the frame's time, also of a moving robot, where known
};

/// Decides which frames become views: only those whose joints are known for certain, because the robot stood
/// still from before the exposure until after it. Stale, moving or mispaired data never becomes a view.
/// Without I/O; not thread-safe; one gate for each sensor.
class ViewGate {
 public:
  explicit ViewGate(const ViewGateSettings& settings) : settings_(settings) {}

  /// Takes up the next frame. usable stands here for "judge() it".
  FrameVerdict enter(std::uint64_t sequence, Clock::time_point stamp);

  /// The frame that was entered last, as often as it takes until the answer is not awaiting_joints.
  FrameDecision judge(const JointHistory& joints, Clock::time_point now) const;

 private:
  FrameVerdict without_joints_around(const JointHistory& joints, Clock::time_point now) const;

  ViewGateSettings settings_;
  std::optional<std::uint64_t> sequence_;
  Clock::time_point stamp_;
};

/// True when the robot has been still for `settle_time` up to its newest state, which is not stale.
bool is_still(const JointHistory& joints, const ViewGateSettings& settings, Clock::time_point now);

}  // namespace calibrd
