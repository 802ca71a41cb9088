// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/json/camera_json.hpp"

#include <boost/json/array.hpp>

namespace calibrd::api {

boost::json::object camera_json(const CameraModel& camera) {
  boost::json::array distortion;
  for (const double k : camera.distortion) distortion.emplace_back(k);
  return {{"width", camera.width},
          {"height", camera.height},
          {"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy},
          {"distortion", std::move(distortion)}};
}

}  // namespace calibrd::api
