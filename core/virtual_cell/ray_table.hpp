// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "core/geometry/pixel_rays.hpp"

namespace calibrd {

/// The viewing directions of a camera, in packets of 4×2 pixels, distortion undone once.
class RayTable {
 public:
  static constexpr int kPacketWidth = 4;
  static constexpr int kPacketHeight = 2;
  static constexpr int kPacketSize = kPacketWidth * kPacketHeight;

  struct Packet {
    float x[kPacketSize];  ///< directions (x, y, 1) in the sensor frame
    float y[kPacketSize];
    Eigen::AlignedBox2f bounds;  ///< of (x, y)
  };

  explicit RayTable(const CameraModel& camera);

  bool fits(const CameraModel& camera) const;
  const PixelRays& pixel_rays() const { return pixel_rays_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  const Packet& packet(int column, int row) const {
    return packets_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                    static_cast<std::size_t>(column)];
  }

 private:
  PixelRays pixel_rays_;
  int columns_ = 0, rows_ = 0;
  std::vector<Packet> packets_;
};

}  // namespace calibrd
