// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "core/global/render_score.hpp"
#include "core/registration/registration_view.hpp"

namespace calibrd {

struct StartSettings {
  std::size_t rotations = 600;        ///< orientations tried, spread evenly over all
  std::size_t surface_points = 4000;  ///< of the robot's moving links, per view
  double voxel_m = 0.04;              ///< of the distance fields
  std::size_t kept_fits =
      60;                  ///< hypotheses after the first, quick fit; half of them are judged by rendering
  std::size_t places = 2;  ///< tried per orientation
  /// A score below this is taken for a search that found nothing: orientations and places are tried once
  /// more, several times as many.
  double hopeless = 0.3;
  double convincing = 0.7;  ///< a score below this is not taken before every hypothesis was judged
};

/// A rough pose and how well it explains the views.
struct StartHypothesis {
  Pose T_base_sensor = Pose::Identity();
  RenderScore score;
};

/// Finds the sensor with no idea where it is, from what moved between the views (`moving`: their
/// robot_candidates()): whatever the moving
/// points' shape fits, all orientations tried, judged by rendering (depth agreement minus free-space
/// violation). Of one view anything may be the robot: what is found then is no more than what it might be.
/// Hypotheses that differ, best first; empty when nothing moved.
std::vector<StartHypothesis> find_starts(std::span<const RegistrationView> views,
                                         std::span<const MovingPoints> moving, const CameraModel& camera,
                                         const StartSettings& settings);

}  // namespace calibrd
