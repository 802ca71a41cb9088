// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace calibrd {

/// Cells (row-major, `width` per row) that hang together: neighbours in a row or a column whose depths differ
/// by less than `step_per_m` times their depth. `depth_m`: 0 = not of interest. Only cells of a block of two
/// by two that hang together count, for edges of the background flicker; clusters of fewer than
/// `least_cells` are left out.
std::vector<std::vector<std::uint32_t>> depth_clusters(std::span<const float> depth_m, int width,
                                                       float step_per_m, std::size_t least_cells);

}  // namespace calibrd
