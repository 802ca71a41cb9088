// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/calibration/check_pose.hpp"
#include "core/drift/background_align.hpp"
#include "core/drift/background_match.hpp"
#include "core/drift/background_word.hpp"
#include "core/drift/drift_report.hpp"
#include "core/drift/robot_word.hpp"
#include "core/drift/scene_change.hpp"
#include "core/drift/shift_dispute.hpp"
#include "core/drift/shift_test.hpp"

namespace calibrd {

struct DriftSettings {
  ShiftTestSettings shift;
  SceneChangeSettings scene;
  double depth_bias_m = 0.003;    ///< a change of the range offset by more is worth a verdict
  double absorb_s = 60;           ///< what has changed and stands for so long becomes background
  double carried_reach_m = 0.35;  ///< what is so near the end of the arm is carried by it
  /// Where one frame of the background leaves a direction less certain than this (one sigma, worst
  /// direction), as a single wall does, it is no evidence that the sensor stands.
  double pinned_m = 0.003, pinned_rad = 0.003;
};

/// Watches one sensor's pose, frame by frame: the remembered background tells within some frames whether the
/// sensor has moved, the robot whether it is the sensor or the robot that is off. Without I/O; one thread.
class DriftWatch {
 public:
  /// The robot of `cell` must outlive it.
  DriftWatch(const VirtualCell& cell, const CameraModel& camera, const DriftSettings& settings);
  DriftWatch(const DriftWatch&) = delete;
  DriftWatch& operator=(const DriftWatch&) = delete;

  /// Another pose, its background not known yet.
  void set_pose(const Pose& T_base_sensor);
  /// The background as the sensor saw it where the pose holds: views it stood still for, of a robot in
  /// different postures (one shows nothing behind the robot). Where they show none, nothing changes.
  void learn(std::span<const View> views);
  /// The background as it was learnt before, for this very pose.
  void set_background(BackgroundMap background);
  bool has_background() const { return !map_.is_empty(); }

  /// The next frame; joint_positions_rad empty when they are not known.
  const DriftReport& add_frame(const View& frame);
  /// What a comparison of a frame with the robot said, which stood as `joints_rad` say. Frames may have come
  /// since.
  void add_check(const PoseCheck& check, std::span<const double> joints_rad, double now_s);

  const DriftReport& report() const { return report_; }
  /// A comparison with the robot would help to decide now.
  bool wants_check() const {
    return is_doubtful() || is_unsettled() || (robot_word_.has_doubt() && !model_wrong_ && !moved_);
  }
  /// The background has been in view, where it was, and has shown every direction, for some frames on end.
  bool is_in_place() const;
  /// Nothing has shown for a while that the sensor stands about where it stood: the background is hidden,
  /// dark or elsewhere, or one thing in view says that it has slid; and the robot has not spoken.
  bool is_out_of_sight() const;
  /// Most of the background has no depth in the last frame: whatever happens meanwhile, nobody sees it.
  bool is_dark() const { return has_background() && report_.dark > kDarkShare; }
  /// Postures on end have spoken against pose and model, and the background does not show that it is the
  /// model; or one thing in view says that the sensor has slid, and the robot has not denied it: while that
  /// lasts no posture that agrees makes the pose good.
  bool is_contested() const;
  /// One thing in view says that the sensor has slid, and the robot has not denied it yet.
  bool is_unsettled() const { return dispute_.is_open() && !dispute_.is_denied(); }
  /// The sensor was away: what was seen before says nothing of where it is now.
  void on_gap();

  const BackgroundMap& background() const { return map_; }
  const BackgroundMatcher& matcher() const { return matcher_; }
  const RobotWord& robot_word() const { return robot_word_; }
  /// Innovation of the last frame about the middle of the background, for whoever studies the test.
  struct Innovation {
    Vector6d turn_shift;
    Matrix6d covariance;
    Vector6d supported_shift;  ///< what the test is given of it: see BackgroundObservation
    Matrix6d supported_covariance;
    double common_share;  ///< as BackgroundObservation
  };
  const std::optional<Innovation>& innovation() const { return innovation_; }

 private:
  void start_over();
  bool is_pinned(const BackgroundAlignment& found) const;
  bool lies_elsewhere(const BackgroundAlignment& found) const;
  void realign(std::span<const std::uint8_t> robot, BackgroundObservation& observation);
  void test(const BackgroundObservation& observation);
  bool pins(const Matrix6d& covariance, double within_m, double within_rad) const;
  void follow_rise();
  void raise_alarm();
  void count_quiet();
  void follow_offset(const BackgroundObservation& observation, double now_s);
  void follow_loss(const BackgroundObservation& observation, double now_s);
  void mark_carried();
  void refine(const BackgroundObservation& observation, double now_s);
  void absorb(double now_s);
  void absorb_what_moved_as_one(double now_s);
  void absorb_what_was_pushed(double now_s);
  bool take(const std::vector<std::uint8_t>& chosen);
  void describe(const BackgroundObservation& observation);
  void judge(double now_s);
  void on_denial();
  double robots_preference(double now_s) const;
  double preference_of(const PoseCheck& check, const Vector6d& turn_shift) const;
  bool is_robots_shift_possible(std::span<const RobotShift> postures) const;
  bool is_one_move(std::span<const RobotShift> postures) const;
  bool has_crept() const;
  bool is_what_was_followed(const RobotShift& robot) const;
  bool is_disputed() const;
  bool is_known_to_stand() const;
  bool is_seen() const;
  bool is_doubtful() const { return test_.statistic() > 0.2 * test_.threshold(); }

  static constexpr double kDarkShare = 0.5;
  static constexpr double kEvidence_s = 1;  // what was seen so lately is of now
  /// The robot is asked ten times a second; one that stands still answers within this.
  static constexpr double kAnswer_s = 0.5;
  /// Where a moved sensor is now is told only when it is known so well.
  static constexpr double kSeenWithin_m = 0.01, kSeenWithin_rad = 0.01;

  DriftSettings settings_;
  CameraModel camera_;
  Pose T_base_sensor_ = Pose::Identity();
  RobotMask robot_;
  std::vector<std::size_t> tips_;  // links
  BackgroundMap map_;
  BackgroundMatcher matcher_;
  SceneChange scene_;
  ShiftTest test_;
  DriftReport report_;
  std::optional<Innovation> innovation_;
  std::optional<Matrix6d> last_covariance_;  // of the last innovation, all parts of the image together
  std::optional<Pose> T_learnt_now_;         // of the last realignment
  std::vector<std::uint8_t> carried_;
  bool moved_ = false, is_refined_ = false, lies_elsewhere_ = false;
  int frames_ = 0, quiet_frames_ = 0, found_frames_ = 0;
  double frame_s_ = 0, evidence_s_ = -1e9, lost_since_s_ = -1, lost_s_ = -1e9, absorbed_s_ = 0,
         learnt_s_ = -1;
  BackgroundWord word_;
  ShiftDispute dispute_;
  double risen_s_ = -1e9, rises_since_s_ = 0;  // the test was, and has been now and then, above 0
  bool was_open_ = false;                      // the background left a direction open before
  double alarmed_since_s_ = -1;                // the test would alarm
  /// What was taken for pushes of boxes, all together, and may have been a sensor that creeps: turn and shift
  /// of the middle of the background.
  Vector6d followed_ = Vector6d::Zero();
  double denied_s_ = -1e9, denied_since_s_ = -1e9;  // the robot said that the sensor stands
  double in_front_s_ = -1e9;                        // last time something was
  double offset_m_ = 0, offset_over_s_ = -1, offset_sigma_m_ = 0;
  bool bias_changed_ = false, model_wrong_ = false;
  RobotWord robot_word_;
};

}  // namespace calibrd
