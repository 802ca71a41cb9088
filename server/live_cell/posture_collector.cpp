// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/posture_collector.hpp"

#include <algorithm>
#include <cmath>

#include "server/live_cell/frame_average.hpp"

namespace calibrd {

double posture_distance(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

void PostureCollector::offer(const View& view) {
  if (is_complete()) return;
  is_waiting_for_motion_ = !is_new(view.joint_positions_rad);
  if (is_waiting_for_motion_) return;
  if (view.is_moving) return take_moving(view);
  const bool same_posture =
      frames_.empty() || posture_distance(frames_.front().joint_positions_rad, view.joint_positions_rad) <
                             settings_.min_distance_rad;
  if (!same_posture) frames_.clear();
  frames_.push_back(view);
  if (static_cast<int>(frames_.size()) < settings_.frames_per_posture) return;
  views_.push_back(average_views(frames_));
  ++seen_;
  frames_.clear();
}

/// A posture that the robot passes is seen once: frames of it cannot be averaged.
void PostureCollector::take_moving(const View& view) {
  frames_.clear();
  if (!settings_.moving_views) return;
  views_.push_back(view);
  ++seen_;
}

void PostureCollector::start_over() {
  views_.clear();
  frames_.clear();
  seen_ = 0;
  is_waiting_for_motion_ = false;
}

bool PostureCollector::is_new(const std::vector<double>& positions) const {
  return std::all_of(views_.begin(), views_.end(), [&](const View& seen) {
    return posture_distance(seen.joint_positions_rad, positions) >= settings_.min_distance_rad;
  });
}

}  // namespace calibrd
