// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace calibrd {

/// Lateral uncertainty (px), about what Nguyen 2012 and Fankhauser 2015 measured: where nothing
/// better is known.
constexpr double kUsualLateral_px = 0.4;

/// How much farther a slanted surface lies one pixel on (m per pixel). `pixel_m`: width of a pixel at 1 m,
/// i.e. 1/fx.
double depth_per_pixel_m(double depth_m, double cos_incidence, double pixel_m);

/// Standard deviation (m) that a time-of-flight depth pixel has at depth `depth_m` when the surface is seen
/// under `cos_incidence` (1 = head on): axial noise after Fankhauser 2015 (Kinect v2), joined by what
/// `lateral_px` of lateral uncertainty does to a slanted surface. Other sensors differ by a factor and in
/// their lateral noise, which the refinement estimates from its residuals.
double depth_sigma_m(double depth_m, double cos_incidence, double pixel_m,
                     double lateral_px = kUsualLateral_px);

}  // namespace calibrd
