// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "core/registration/registration_view.hpp"

namespace calibrd {

/// Views per posture, at least 1. What is wrong with the model, the range or the joints is wrong by the same
/// in every view of one posture: looking again makes a calibration no surer than looking once.
double views_per_posture(std::span<const RegistrationView> views);

}  // namespace calibrd
