// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <span>
#include <vector>

#include "core/calibration/calibrate.hpp"
#include "core/registration/registration_view.hpp"

namespace calibrd {

struct DiagnoseSettings {
  std::size_t views = 4;      ///< so many are looked at
  double least_score = 0.65;  ///< see RenderScore: an explanation must fit this well ...
  double least_gain = 0.02;   ///< ... so much better than the input as it came ...
  double least_mended = 0.4;  ///< ... and mend this share of what the input leaves open
  double convincing = 0.95;   ///< nothing further is tried when an explanation fits so well
  /// No explanation is begun after it.
  std::chrono::milliseconds budget{6000};
};

/// Where the search has been before it was rejected.
struct TriedPoses {
  std::vector<Pose> T_base_sensor;  ///< a guess, what was found
  bool surface_differs = false;     ///< the measured surface has another shape than the model's
};

/// Looks for what makes views fit that were rejected: a mirrored sensor, swapped intrinsics, joints in
/// another order or with other signs, joints of another frame, a robot that moved. Gives the
/// explanation that fits best as a reason to add; when none does though something moved, robot_model_wrong.
/// `views` must stand at their reported joints. Costs up to the budget and one explanation more.
std::optional<Reason> diagnose(std::span<const RegistrationView> views, const CameraModel& camera,
                               const TriedPoses& tried, const DiagnoseSettings& settings);

}  // namespace calibrd
