// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pixel_rays.hpp"

#include <tbb/parallel_for.h>

namespace calibrd {

PixelRays::PixelRays(const CameraModel& camera)
    : camera_(camera),
      directions_(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height)) {
  tbb::parallel_for(0, camera.height, [&](int y) {
    Eigen::Vector2d* row =
        directions_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width);
    for (int x = 0; x < camera.width; ++x) row[x] = camera.ray(x, y).head<2>();
  });
}

}  // namespace calibrd
