// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "core/global/moving_points.hpp"

namespace calibrd {

/// How well a pose explains all views, judged by what the virtual sensor shows from it.
struct RenderScore {
  std::size_t predicted = 0;     ///< robot pixels with a measurement
  std::size_t agreeing = 0;      ///< ... that lies where the robot should be
  std::size_t seen_through = 0;  ///< ... that lies behind: the robot cannot be there
  std::size_t moving = 0;        ///< pixels of what moved between the views
  std::size_t explained = 0;     ///< ... that the robot explains
  /// Depth agreement minus free-space violation, with what moved and found its explanation: 1 = perfect, and
  /// below 0 for a pose that contradicts more than it explains.
  double value() const;
  void merge(const RenderScore& other);
};

struct RenderScoreSettings {
  int reduction = 8;          ///< one ray per so many pixels in both directions
  double tolerance_m = 0.05;  ///< the start is rough, and the range is biased
};

/// One score per pose. `moving`: one per view, as robot_candidates() gives them; empty when nothing is known
/// of that.
std::vector<RenderScore> render_scores(std::span<const RegistrationView> views,
                                       std::span<const MovingPoints> moving, const CameraModel& camera,
                                       std::span<const Pose> poses_base_sensor,
                                       const RenderScoreSettings& settings);

}  // namespace calibrd
