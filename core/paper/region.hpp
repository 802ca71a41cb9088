// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <string_view>

#include "core/base/result.hpp"

namespace calibrd {

/// A box from `x0,y0,z0,x1,y1,z1` (m, finite, the first corner below the second on every axis). Errors:
/// PaperError::bad_region.
Result<Eigen::AlignedBox3d> parse_region(std::string_view text);

}  // namespace calibrd
