// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/track_error.hpp"

namespace calibrd {
namespace {

class TrackErrorCategory final : public std::error_category {
 public:
  const char* name() const noexcept override { return "track"; }
  std::string message(int value) const override {
    switch (static_cast<TrackError>(value)) {
      case TrackError::wrong_image_size:
        return "the depth image has not the size of the camera model; check the sensor's configuration";
      case TrackError::wrong_joints:
        return "the joint positions do not fit the robot model; check joint names and controller";
      case TrackError::too_few_pixels:
        return "too few pixels show the robot where the pose puts it; bring it into view, clear what hides "
               "it, or recalibrate";
      case TrackError::unobservable:
        return "what is seen of the robot leaves a direction open; wait for another posture";
    }
    return "unknown tracking error";
  }
};

}  // namespace

const std::error_category& track_error_category() {
  static const TrackErrorCategory category;
  return category;
}

}  // namespace calibrd
