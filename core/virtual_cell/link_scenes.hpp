// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <vector>

#include "core/robot/robot_model.hpp"
#include "core/virtual_cell/embree_shim.hpp"

namespace calibrd {

/// The surfaces of a robot's links as Embree scenes in their link frames: built once, shared by every virtual
/// cell of that robot. Immutable after construction.
class LinkScenes {
 public:
  explicit LinkScenes(const RobotModel& robot);
  ~LinkScenes();
  LinkScenes(const LinkScenes&) = delete;
  LinkScenes& operator=(const LinkScenes&) = delete;

  struct Surface {
    int link = -1;
    RTCScene scene = nullptr;
    Eigen::AlignedBox3f bounds;  ///< link frame, m
  };

  RTCDevice device() const { return device_; }
  const std::vector<Surface>& surfaces() const { return surfaces_; }

 private:
  RTCDevice device_ = nullptr;
  std::vector<Surface> surfaces_;
};

}  // namespace calibrd
