// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "core/calibration/view.hpp"

namespace calibrd {

/// One view of several of the same posture. Depth: where at least half of the frames measured, the mean of
/// what lies within 2 cm of the median, so that a pixel that jumps between foreground and background is not
/// put between them; else no measurement. The unit of the depth is made finer where the range allows it, so
/// that the mean keeps its digits. Image and joints: the mean. All views must have the same sizes; one view
/// is returned as it is.
View average_views(std::span<const View> views);

/// Brings the depth of all views to one unit, as a capture has: the finest of theirs that all depths fit.
void bring_to_one_unit(std::span<View> views);

}  // namespace calibrd
