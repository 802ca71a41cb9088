// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "core/calibration/view.hpp"
#include "core/geometry/camera_model.hpp"
#include "core/geometry/pose.hpp"
#include "core/paper/paper_settings.hpp"
#include "core/robot/robot_model.hpp"

namespace calibrd {

using Points = std::vector<Eigen::Vector3f>;
inline constexpr std::size_t kFewestPoints = 10;  ///< fewer are no measurement of a robot

/// A box in the frame that `T_box_sensor` leads to.
struct Region {
  Pose T_box_sensor = Pose::Identity();
  Eigen::AlignedBox3d box;
};

/// The virtual measurement as points spread over the CAD surface, base frame.
Points sampled_uniformly(const RobotModel& robot, const View& view, const PaperSettings& settings);

/// What three virtual sensors see of the robot, together, base frame. They stand around the base's z axis
/// through the robot's middle, a third of a turn apart; the first stands at `T_base_virtual`.
Points seen_by_three_sensors(const RobotModel& robot, const CameraModel& camera, const View& view,
                             const Pose& T_base_virtual);

/// The measured points within the region, sensor frame.
Points measured_in(const Region& region, const CameraModel& camera, const View& view);

Points moved(const Pose& T_to_from, const Points& points_from);

Eigen::AlignedBox3d box_around(const Points& points);

/// The box around the robot's points (base frame), larger by `margin_m` on each side, but smaller by as much
/// at the bottom: what the robot stands on is left out (section IV.A: "with the exception of a flat work
/// platform surface").
Eigen::AlignedBox3d region_of_robot(const Points& points_base, double margin_m);

}  // namespace calibrd
