// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/global/find_start.hpp"
#include "core/registration/registration_view.hpp"

namespace calibrd {

/// Where the calibration starts without a guess, and by how much nothing else explains the views as well.
struct ChosenStart {
  Pose T_base_sensor = Pose::Identity();
  std::vector<Pose> others;      ///< hypotheses elsewhere, best first, two at most
  std::optional<double> margin;  ///< score over the first of them; nothing when there is none
};

/// Where the robot might be in a single view, best first, at most five: nothing moved, so anything may be it.
std::vector<StartHypothesis> starts_of_one(const RegistrationView& view, const CameraModel& camera);

/// The best of find_starts(). Where the runner-up comes close, both are pulled onto the surface and judged
/// again, finer: they may turn out to be the same, or change places. Nothing when nothing moved.
std::optional<ChosenStart> choose_start(std::span<const RegistrationView> views, const CameraModel& camera);

}  // namespace calibrd
