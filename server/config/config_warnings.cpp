// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/config_warnings.hpp"

namespace calibrd {
namespace {

constexpr const char* kWhy =
    " like defaults, not like a calibration of this sensor; wrong intrinsics move the pose by millimetres to "
    "centimetres, and no view shows it";

/// By either convention: the centre of the first pixel is 0, or its corner.
bool is_centre(double coordinate, int side) {
  return coordinate == (side - 1) / 2.0 || coordinate == side / 2.0;
}

}  // namespace

std::vector<std::string> config_warnings(const Config& config) {
  std::vector<std::string> warnings;
  for (const auto& [id, sensor] : config.sensors) {
    const auto& camera = sensor.camera;
    if (is_centre(camera.cx, camera.width) && is_centre(camera.cy, camera.height))
      warnings.push_back("sensors." + id + ": cx and cy are exactly the centre of the image: these look" +
                         kWhy);
    if (!camera.is_distorted())
      warnings.push_back("sensors." + id + ": distortion is all zero: this looks" + kWhy +
                         " (right only where the device removes the distortion itself)");
  }
  const bool is_reached = config.server.address != "127.0.0.1" && config.server.address != "::1";
  const bool is_open = is_reached && config.server.tokens_file.empty() && config.server.tls.client_ca.empty();
  if (is_open)
    warnings.push_back("server.allow_unauthenticated with server.address = \"" + config.server.address +
                       "\": whoever reaches the port may do everything, without a token");
  if (config.motion.enabled && is_open)
    warnings.push_back("motion.enabled with server.address = \"" + config.server.address +
                       "\": no token is asked for, so whoever reaches the port can move the robot");
  return warnings;
}

}  // namespace calibrd
