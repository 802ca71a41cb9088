// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/base/result.hpp"

namespace calibrd {

/// The second image of a frame, in the depth image's pixel grid.
enum class ImageKind {
  none,
  infrared,  ///< where the device has it
  color      ///< made grey; only where the device registers depth to colour
};

/// What calibrd-sensor is asked to deliver.
struct StreamRequest {
  /// Which device: empty = the first one; a URI; a pattern for URIs (with `*`); or `serial:NUMBER`.
  std::string device;
  std::string recording;  ///< path of an .oni file to play instead of a device
  double speed = 1.0;     ///< of the recording; 1 = as recorded
  bool loop = false;      ///< plays the recording again and again
  int width = 0;          ///< px, must be the sensor's own
  int height = 0;         ///< px
  int fps = 30;           ///< frames per second; 0 = the highest offered at this size
  int depth_unit_um =
      1000;  ///< preferred unit of the depth values, 1000 or 100; the other one where it is not offered
  ImageKind image = ImageKind::infrared;
  /// Flips every row. Only for drivers that deliver mirrored images and deny it: mirroring the driver admits
  /// to is switched off or undone anyway.
  bool mirror = false;
};

/// Refuses values no sensor can have, naming the key.
Status check(const StreamRequest& request);

/// The request as command line arguments of calibrd-sensor, and back.
std::vector<std::string> to_arguments(const StreamRequest& request);
Result<StreamRequest> request_from_arguments(std::span<const std::string> arguments);

}  // namespace calibrd
