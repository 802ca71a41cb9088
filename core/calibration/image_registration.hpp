// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "core/registration/registration_view.hpp"

namespace calibrd {

/// Where in the images the robot's predicted outline finds its edges. Shares are 0..1: 1 where every point of
/// the outline lies on the strongest edge of its surroundings.
struct ImageRegistration {
  std::size_t outline_points = 0;      ///< looked at; 0 when there are no images
  double here = 0;                     ///< share where the outline is predicted
  double elsewhere = 0;                ///< ... when all of it is moved by the shift that suits it best
  int shift_x_px = 0, shift_y_px = 0;  ///< that shift
  double mirrored = 0;                 ///< best share in the images mirrored left to right
  double other_view = 0;               ///< share in the images of the view before or after
};

/// Moves the outlines of all views together over the images: those of an image that is registered to the
/// depth lie on edges where they are predicted, and nowhere else as well. `predictions`: what the views'
/// cells show. `mirrored` and `other_view` are looked at only when `here` does not convince.
ImageRegistration look_at_images(std::span<const RegistrationView> views,
                                 std::span<const VirtualMeasurement> predictions, const CameraModel& camera);

}  // namespace calibrd
