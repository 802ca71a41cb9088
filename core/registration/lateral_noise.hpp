// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>

#include "core/registration/normal_equations.hpp"

namespace calibrd {

/// Lateral noise (px) with which residuals on slanted surfaces scatter as much, whitened, as those on
/// surfaces seen head on. `lateral_px` and `sigma_factor`: with which the samples' sigmas were made. Nothing
/// when too little is seen of either kind.
std::optional<double> find_lateral_noise(std::span<const Sample> samples, double lateral_px,
                                         double sigma_factor);

}  // namespace calibrd
