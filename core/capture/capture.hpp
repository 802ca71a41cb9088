// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "core/calibration/view.hpp"
#include "core/geometry/camera_model.hpp"

namespace calibrd {

/// A recording in the capture/1 format: a folder with capture.json and 16-bit PNG images (docs/capture.md).
struct Capture {
  std::string note;
  std::filesystem::path urdf;  ///< where the robot model lies, resolved to an existing file by read_capture
  std::string base_link;       ///< empty: the URDF's root
  std::vector<std::string> joint_names;  ///< order of joint_positions_rad in every view of `views`
  std::string sensor_id;
  CameraModel camera;
  std::vector<View> views;
};

enum class CaptureImages { read, ignore };

/// Reads CAPTURE_DIR/capture.json, its depth images, and the others unless they are to be ignored. `models`:
/// folders to look the URDF and its meshes up in, after the capture itself. Errors: CaptureError, each naming
/// the file or key at fault.
Result<Capture> read_capture(const std::filesystem::path& capture_dir,
                             std::span<const std::filesystem::path> models,
                             CaptureImages images = CaptureImages::read);

/// Writes a capture into `capture_dir` (created; must be empty or absent). `urdf_reference` is stored as
/// robot.urdf. Either the whole recording stands there afterwards, or an error says why not.
Status write_capture(const std::filesystem::path& capture_dir, const Capture& capture,
                     const std::string& urdf_reference);

}  // namespace calibrd
