// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace calibrd {

/// Standard deviation (m) that a time-of-flight depth pixel has at depth `depth_m` when the surface is seen
/// under `cos_incidence` (1 = head on): axial noise after Fankhauser 2015 (Kinect v2), joined by what half a
/// pixel of lateral uncertainty does to a slanted surface. `pixel_m`: width of a pixel at 1 m, i.e. 1/fx.
/// Other sensors differ by a factor, which the refinement estimates from its residuals.
double depth_sigma_m(double depth_m, double cos_incidence, double pixel_m);

}  // namespace calibrd
