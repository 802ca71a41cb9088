// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What DriftWatch says of the sensor, from what it has gathered.
#include <algorithm>

#include "core/drift/drift_watch.hpp"

namespace calibrd {
namespace {

constexpr int kQuietFrames = 10;
constexpr double kInFront_s = 0.5;  // a verdict outlives what it speaks of by so long
constexpr double kRobotHolds_s = 10;
/// A person who passes is no reason to doubt; a lens that is covered is: nobody passes so near.
constexpr double kOutOfSight_s = 2, kDark_s = 0.5;
constexpr double kDisputed_s = 0.6;  // unsettled for so long: time for the robot to deny it

}  // namespace

bool DriftWatch::is_in_place() const {
  return has_background() && !moved_ && word_.pins_within(kEvidence_s, frame_s_) && !is_doubtful() &&
         quiet_frames_ >= kQuietFrames;
}

/// Something has said just now that the sensor stands, in every direction.
bool DriftWatch::is_known_to_stand() const {
  return word_.pins_within(kEvidence_s, frame_s_) || robot_word_.agrees_within(RobotWord::kOfNow_s, frame_s_);
}

/// A wall leaves directions open: of these the robot's word holds longer, while it works and the wall stands.
bool DriftWatch::is_seen() const {
  const bool told = robot_word_.agrees_within(kRobotHolds_s, frame_s_);
  return is_known_to_stand() || (told && frame_s_ - evidence_s_ < kEvidence_s);
}

bool DriftWatch::is_out_of_sight() const {
  const double patience_s = is_dark() ? kDark_s : kOutOfSight_s;
  const bool is_nowhere = frame_s_ - std::max(evidence_s_, learnt_s_) > patience_s;
  return has_background() &&
         (is_disputed() || (is_nowhere && !robot_word_.agrees_since(frame_s_ - kOutOfSight_s, frame_s_)));
}

/// A comparison with the robot agrees within its own uncertainty, which may be more than the slide: what
/// counts is which of the two it speaks for.
bool DriftWatch::is_disputed() const {
  return dispute_.is_open_for(kDisputed_s, frame_s_) && !dispute_.is_denied();
}

bool DriftWatch::is_contested() const {
  return is_disputed() || (model_wrong_ && !word_.pins_within(kEvidence_s, frame_s_));
}

void DriftWatch::judge(double now_s) {
  const bool in_front = now_s - in_front_s_ < kInFront_s;
  if (moved_)
    report_.verdict = DriftVerdict::sensor_moved;
  else if (model_wrong_)
    report_.verdict = DriftVerdict::robot_model_wrong;
  else if (!is_seen() || is_disputed())
    report_.verdict =
        in_front || report_.nearer > 0.5 ? DriftVerdict::something_in_front : DriftVerdict::no_evidence;
  else if (bias_changed_)
    report_.verdict = DriftVerdict::depth_bias_changed;
  else if (scene_.has_changed() || now_s - denied_s_ < kEvidence_s)
    report_.verdict = DriftVerdict::scene_changed;
  else
    report_.verdict = in_front ? DriftVerdict::something_in_front : DriftVerdict::in_place;
}

}  // namespace calibrd
