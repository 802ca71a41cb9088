// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/virtual_cell/ray_table.hpp"

#include <algorithm>

namespace calibrd {

RayTable::RayTable(const CameraModel& camera)
    : pixel_rays_(camera),
      columns_((camera.width + kPacketWidth - 1) / kPacketWidth),
      rows_((camera.height + kPacketHeight - 1) / kPacketHeight),
      packets_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      Packet& packet = packets_[static_cast<std::size_t>(row * columns_ + column)];
      for (int k = 0; k < kPacketSize; ++k) {
        // Packets that stick out of the image repeat its last pixel, so that every ray is valid.
        const int u = std::min(column * kPacketWidth + k % kPacketWidth, camera.width - 1);
        const int v = std::min(row * kPacketHeight + k / kPacketWidth, camera.height - 1);
        const Eigen::Vector2f direction = pixel_rays_.at(u, v).head<2>().cast<float>();
        packet.x[k] = direction.x();
        packet.y[k] = direction.y();
        packet.bounds.extend(direction);
      }
    }
  }
}

bool RayTable::fits(const CameraModel& camera) const { return camera == pixel_rays_.camera(); }

}  // namespace calibrd
