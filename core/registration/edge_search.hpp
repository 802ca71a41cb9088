// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "core/registration/contour_edges.hpp"

namespace calibrd {

/// What lies this much further back than a contour's rim is beyond the contour.
constexpr float kContourStep_m = 0.03F;
inline bool beyond(float depth_m, float rim_depth_m) {
  return depth_m <= 0 || depth_m > rim_depth_m + kContourStep_m;
}

/// Where an image edge lies (px along the normal from the predicted contour), and how sure that is.
struct Edge {
  double distance_px;
  double sigma_px;
};

/// The strongest step of the image near the contour: reaches far, but is biased by shading.
std::optional<Edge> find_step(const RegistrationView& view, const CameraModel& camera,
                              const ContourPoint& point, const ContourSettings& settings);

/// Where the measured depth leaves the robot's: for views without an image. Coarser, and biased by how the
/// sensor fattens or frays what stands in front, which the estimated shift of all contours takes up.
std::optional<Edge> find_depth_step(const RegistrationView& view, const CameraModel& camera,
                                    const ContourPoint& point, const ContourSettings& settings);

/// The move by which the modelled light profile fits the image; nothing when it explains the profile badly,
/// which is then of something else.
std::optional<Edge> fit_profile(const RegistrationView& view, const CameraModel& camera,
                                const Pose& T_base_sensor, const ContourPoint& point,
                                const ContourSettings& settings);

}  // namespace calibrd
