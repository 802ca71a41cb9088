// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/calibration/check_pose.hpp"
#include "core/drift/posture_mean.hpp"

namespace calibrd {

/// What comparisons of frames with the robot say of a pose: the newest one, and a CUSUM over postures of how
/// far off the robot looks. Comparisons of one posture all err alike, and a part in the gripper may look like
/// the robot: a posture has one word, and one posture alone says nothing against the pose. Without I/O.
class RobotWord {
 public:
  void reset() { *this = RobotWord(); }
  /// `joints`: of the frame. A comparison without enough evidence is none.
  void add(const PoseCheck& check, std::span<const double> joints, double now_s);

  const std::optional<PoseCheck>& newest() const { return newest_; }
  double age_s(double now_s) const { return now_s - stamp_s_; }
  /// The newest one agrees, is of after `since_s`, and of now.
  bool agrees_since(double since_s, double now_s) const;
  /// The newest one agrees and is not older than this.
  bool agrees_within(double seconds, double now_s) const;
  /// There is one that is not older than this.
  bool has_spoken_within(double seconds, double now_s) const { return newest_ && age_s(now_s) < seconds; }
  /// The newest one disagrees, and is of this very moment.
  bool is_off(double now_s) const;

  /// What speaks against the pose, of kLimit: 1 = it is too much ...
  double doubt() const { return statistic_ / kLimit; }
  /// ... and what the last postures together show, of kCreepSigmas.
  double creep_doubt() const;
  bool has_doubt() const { return statistic_ > 0; }
  /// Postures on end have spoken against pose and model, for a second or more ...
  bool is_against() const;
  /// ... of each of them, since the doubt began, its newest comparison ...
  std::vector<PoseCheck> doubts() const;
  /// ... or do so no longer.
  bool is_against_no_more() const;

  /// The last postures together, none of which says much, say that the robot is not where it should be: this
  /// far off. Nothing: they do not.
  std::optional<RobotShift> creep() const;

  static constexpr double kOfNow_s = 2;  ///< a comparison is of now for so long
  static constexpr double kLimit = 5.5;
  /// Of the postures together (docs/figures.md has what it finds).
  static constexpr double kCreepSigmas = 4;

 private:
  std::optional<PoseCheck> newest_;
  double stamp_s_ = -1e9;
  double statistic_ = 0, before_posture_ = 0, doubt_since_s_ = 0;
  std::vector<double> posture_;  // that is looked at
  double posture_sigmas_ = 0;    // mean of its comparisons
  int posture_checks_ = 0;
  std::vector<PoseCheck> doubts_;  // of postures that it has left
  PostureMean mean_;
};

}  // namespace calibrd
