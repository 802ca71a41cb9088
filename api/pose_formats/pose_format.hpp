// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/json/object.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/geometry/pose.hpp"
#include "core/robot/controller_frame.hpp"

namespace calibrd::api {

/// A pose and the names of its frames: p_to = T_to_from * p_from. Metres.
struct FramedPose {
  Pose T_to_from;
  std::string to_frame, from_frame;
};

/// What a format gives the pose of, and in which frame.
enum class Reference {
  base,        ///< T_base_sensor
  controller,  ///< T_controller_sensor: as the robot's controller counts
  inverse,     ///< T_sensor_base
};

/// One format of a pose, and everything a reader must know of it. docs/pose_formats.md says the same at
/// length.
struct PoseFormat {
  const char* name;
  Reference reference;
  const char* length_unit;
  const char* angle_unit;   ///< null: there are no angles
  const char* order;        ///< of the numbers
  const char* rotation;     ///< what they mean
  const char* singularity;  ///< what is chosen where several values mean the same rotation; null: nowhere
  const char* source;       ///< manual or page that says so
  void (*write)(boost::json::object& body, const FramedPose& pose);  ///< adds the numbers, and text of them
};

std::span<const PoseFormat> pose_formats();
/// Null: there is none of that name.
const PoseFormat* find_pose_format(std::string_view name);
/// "matrix, quaternion, …".
std::string pose_format_names();

/// The pose in the frames that a format gives it in. Nothing: it is given in the controller's frame, and
/// there is none.
std::optional<FramedPose> refer(const FramedPose& sensor_in_base, Reference reference,
                                const std::optional<ControllerFrame>& controller);

/// The members of a payload: labels, numbers, text. `pose` as refer() returns it for that format.
boost::json::object pose_members(const PoseFormat& format, const FramedPose& pose);

}  // namespace calibrd::api
