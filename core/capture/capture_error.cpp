// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/capture/capture_error.hpp"

namespace calibrd {
namespace {

class CaptureErrorCategory final : public std::error_category {
 public:
  const char* name() const noexcept override { return "capture"; }
  std::string message(int value) const override {
    switch (static_cast<CaptureError>(value)) {
      case CaptureError::no_such_folder:
        return "there is no such folder; give the folder that holds capture.json";
      case CaptureError::unreadable:
        return "the file cannot be read; check that it exists and its permissions";
      case CaptureError::file_too_large:
        return "the file is far larger than any recording needs; check that it is the right one";
      case CaptureError::path_outside:
        return "the images of a recording lie in its own folder; give a path relative to it, without \"..\"";
      case CaptureError::bad_json:
        return "this is not valid JSON; mend it at the place named";
      case CaptureError::wrong_format:
        return "the format is not \"capture/1\"; only capture/1 recordings can be read";
      case CaptureError::missing_key:
        return "this key is missing in capture.json; add it (docs/capture.md lists all keys)";
      case CaptureError::bad_value:
        return "this value cannot be used; docs/capture.md states what is expected";
      case CaptureError::no_frames:
        return "the recording holds no frame; record at least one posture";
      case CaptureError::urdf_not_found:
        return "the robot's URDF was not found in the capture nor in any --models folder; add the folder "
               "that holds it with --models";
      case CaptureError::bad_png:
        return "this is not a readable PNG image; record the frame again or remove it from capture.json";
      case CaptureError::wrong_image_size:
        return "the image is not of the size that sensor.width and sensor.height state; depth and image must "
               "share the sensor's pixel grid";
      case CaptureError::wrong_bit_depth:
        return "a depth image must be a 16-bit single-channel PNG (an 8-bit one has lost the depth); export "
               "it again";
      case CaptureError::wrong_joint_count:
        return "joint_positions_rad must hold one finite number for each of robot.joint_names, in that "
               "order; mend or remove the frame";
      case CaptureError::unknown_joint:
        return "robot.joint_names names a joint that the robot model does not have; use the URDF's joint "
               "names";
      case CaptureError::missing_joint:
        return "the robot model has a joint that robot.joint_names leaves out; record a position for every "
               "movable joint";
      case CaptureError::duplicate_joint:
        return "robot.joint_names names this joint twice; name each joint once";
      case CaptureError::folder_not_empty:
        return "the folder is not empty; name a new one, recordings are never overwritten";
      case CaptureError::unwritable:
        return "writing failed; check permissions and free space";
      case CaptureError::bad_pose_file:
        return "not a pose; give a JSON file that holds \"T_base_sensor\" (4x4, 3x4 or 12 row-major numbers, "
               "a proper rotation, metres) or x,y,z,qx,qy,qz,qw";
    }
    return "unknown capture error";
  }
};

}  // namespace

const std::error_category& capture_error_category() {
  static const CaptureErrorCategory category;
  return category;
}

}  // namespace calibrd
