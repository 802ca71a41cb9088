// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/sensing/images.hpp"
#include "server/live_cell/frame_cadence.hpp"
#include "server/live_cell/joint_history.hpp"
#include "server/live_cell/view_timing.hpp"

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
  wrong_size,     ///< not the size of the camera model
  joints_frozen,  ///< the controller's status lives, its joints do not
  timed  ///< robot moving, joints of the frame's time known well enough: a view, where such are taken
};
inline constexpr std::size_t kFrameVerdicts = 10;

/// Stable name for programs: "usable", "moving", …
const char* name_of(FrameVerdict verdict);
/// Why the frame is no view and what to do about it; empty for a usable one.
const char* reason_of(FrameVerdict verdict);

struct ViewGateSettings {
  Clock::duration stale_after = std::chrono::milliseconds(250);
  Clock::duration settle_time = std::chrono::milliseconds(300);
  Clock::duration latency{0};  ///< from exposure to the frame's stamp
  /// Joints may be told so late after the moment they are of, where the time offset is not estimated: a robot
  /// that begins to move so soon after the exposure may have moved during it.
  Clock::duration lateness = std::chrono::milliseconds(100);
  double still_speed_rad_s = 0.002;  ///< the robot is still while no joint is faster
  bool trust_in_motion = true;       ///< a robot whose controller says that it moves is not still
  bool timed_views = false;          ///< frames of a moving robot may be views, too
  /// ... when no point of it is farther than this from where the joints put it: below what one view's noise
  /// does to a pose, and a time that is off by the same in every view is not averaged away.
  double largest_timing_error_m = 0.3e-3;
  /// Where messages that came late leave the robot less certain than this, its joints are not known at all.
  double largest_late_error_m = 0.01;
};

struct FrameDecision {
  FrameVerdict verdict = FrameVerdict::no_joints;
  std::optional<std::vector<double>>
      positions_rad;            ///< at the frame's time, also of a moving robot, where known
  Clock::time_point exposed{};  ///< the moment they are of
  /// How far (m) any point of the robot may be from where these positions put it, because the frame's time is
  /// known so well only (1 sigma); 0 while it stands still, nothing where the time offset is not estimated.
  std::optional<double> timing_error_m = std::nullopt;
};

/// Decides which frames become views: only those whose joints are known for certain, because the robot stood
/// still from before the exposure until after it. Stale, moving or mispaired data never becomes a view.
/// Without I/O; not thread-safe; one gate for each sensor.
class ViewGate {
 public:
  /// `reach`: of the robot; without it nothing is said about frames of a moving robot.
  explicit ViewGate(const ViewGateSettings& settings, std::shared_ptr<const LinkReach> reach = nullptr)
      : settings_(settings), reach_(std::move(reach)) {}

  /// Takes up the next frame. usable stands here for "judge() it". `depth`: its pixels, where there are any:
  /// a whole frame that is the same to the last bit is the one before it, whatever its number and stamp.
  FrameVerdict enter(std::uint64_t sequence, Clock::time_point stamp, const DepthImage* depth = nullptr);

  /// The time offset that frames are judged with from now on; nothing: it is not known.
  void set_offset(const std::optional<AppliedOffset>& offset) { offset_ = offset; }

  /// The frame that arrived at `stamp`, as often as it takes until the answer is not awaiting_joints.
  FrameDecision judge(const JointHistory& joints, Clock::time_point stamp, Clock::time_point now) const;
  /// The frame that was entered last.
  FrameDecision judge(const JointHistory& joints, Clock::time_point now) const {
    return judge(joints, stamp_, now);
  }

 private:
  FrameVerdict without_joints_around(const JointHistory& joints, Clock::time_point exposed,
                                     Clock::time_point now) const;
  FrameVerdict judge_motion(const JointHistory& joints, FrameDecision& decision, double frame_delay_s,
                            Clock::time_point now) const;
  FrameVerdict judge_stillness(const JointHistory& joints, Clock::time_point exposed,
                               Clock::time_point now) const;

  ViewGateSettings settings_;
  std::shared_ptr<const LinkReach> reach_;
  std::optional<AppliedOffset> offset_;
  FrameCadence cadence_;
  std::optional<std::uint64_t> sequence_;
  std::optional<std::uint64_t> pixels_;  // fingerprint of the frame before
  Clock::time_point stamp_;
};

/// True when the robot has been still for `settle_time` up to its newest state, which is not stale.
bool is_still(const JointHistory& joints, const ViewGateSettings& settings, Clock::time_point now);

}  // namespace calibrd
