// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace calibrd {

/// A sensor that has moved less, m, and turned less, rad, stands.
inline constexpr double kStandsWithin = 0.0005;

}  // namespace calibrd
