// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "core/calibration/view.hpp"

namespace calibrd {

struct CollectorSettings {
  int postures = 5;
  double min_distance_rad = 0.17;  ///< another posture: some joint differs by this much
  int frames_per_posture = 1;
  bool moving_views = false;  ///< takes views of a moving robot, too: one for each posture
};

/// Collects views of different postures, several frames of each. Without I/O; not thread-safe.
class PostureCollector {
 public:
  explicit PostureCollector(const CollectorSettings& settings) : settings_(settings) {}

  /// Takes a view of the robot holding still; copies it when it is of use.
  void offer(const View& view);
  /// The robot has moved: frames of a posture that is not complete yet are dropped.
  void interrupt() { frames_.clear(); }

  /// The sensor may have been moved: what it has seen so far is dropped.
  void start_over();

  /// The postures seen are enough, once there are `least`.
  void settle_for_less(int least) {
    if (seen_ >= least) settings_.postures = seen_;
  }

  bool is_complete() const { return seen() >= settings_.postures; }
  int seen() const { return seen_; }  ///< also once they are taken
  /// The last view offered was of a posture already seen.
  bool is_waiting_for_motion() const { return is_waiting_for_motion_; }

  /// One view for each posture, averaged. A complete collector stays complete.
  std::vector<View> take_views() { return std::move(views_); }

 private:
  void take_moving(const View& view);
  bool is_new(const std::vector<double>& positions) const;

  CollectorSettings settings_;
  std::vector<View> views_;
  std::vector<View> frames_;  // of the posture being seen
  int seen_ = 0;
  bool is_waiting_for_motion_ = false;
};

/// Largest difference of any one joint, rad. The sizes must be the same.
double posture_distance(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace calibrd
