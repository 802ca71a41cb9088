// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <span>
#include <string>

#include "core/base/result.hpp"
#include "core/geometry/camera_model.hpp"

// What every recording keeps to, asked by reader and writer alike: what is written can be read.
namespace calibrd {

/// A size of 8 to 8192 pixels, focal lengths above 0, a principal point near the image, and a distortion that
/// can be undone over the inner half of the image. Errors: CaptureError::bad_value.
Status check_camera(const CameraModel& camera);

/// Between a micrometre and a decimetre per unit. Errors: CaptureError::bad_value.
Status check_depth_scale(double depth_scale_m);

/// One finite value for each of `joint_count` names. `key` names the list in the error.
/// Errors: CaptureError::wrong_joint_count.
Status check_joints(std::span<const double> positions_rad, std::size_t joint_count, const std::string& key);

/// At least one frame, and no more than fit into memory. Errors: CaptureError::no_frames, bad_value.
Status check_frame_count(std::size_t frames, const CameraModel& camera);

/// Errors: CaptureError::wrong_image_size; `file` is named in it.
Status check_image_size(int width, int height, const CameraModel& camera, const std::string& file);

}  // namespace calibrd
