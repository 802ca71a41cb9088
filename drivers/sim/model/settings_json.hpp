// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/json.hpp>

#include "drivers/sim/model/fields.hpp"
#include "drivers/sim/world/cell.hpp"
#include "drivers/sim/world/controller_settings.hpp"
#include "drivers/sim/world/state.hpp"

namespace calibrd::sim {

// How settings read in JSON: the same in the world description and in the control calls. Each read_ function
// changes what the fields name and leaves the rest; the caller calls Fields::finish().

/// preset ("none" | "kinect2"), then single values on top.
void read_depth_errors(Fields& fields, DepthErrors& errors);
void read_infrared_errors(Fields& fields, InfraredErrors& errors);
void read_camera(Fields& fields, CameraParameters& camera);
void read_controller(Fields& fields, ControllerSettings& settings);
void read_person(Fields& fields, PersonState& person, std::int64_t now_ns);

/// T_base_sensor (key `matrix`), or position_m with target_m and roll_deg, or position_m with rpy_deg.
void read_pose(Fields& fields, std::string_view matrix, Eigen::Isometry3d& pose);

boost::json::object depth_errors_json(const DepthErrors& errors);
boost::json::object infrared_errors_json(const InfraredErrors& errors);
boost::json::object camera_json(const CameraParameters& camera);
boost::json::object controller_json(const ControllerSettings& settings);

/// What the robot is to do.
struct MotionCommand {
  enum class Mode {
    run,       ///< `count` random postures, clear of the cell, for ever
    hold,      ///< comes to rest where it is
    resume,    ///< goes on after a hold
    jog,       ///< one joint to and fro at constant speed
    postures,  ///< the stated postures, for ever
  } mode = Mode::hold;
  std::uint64_t seed = 1;
  std::int32_t count = 12;  ///< of random postures
  double speed_rad_s = 0.5;
  double hold_s = 1.0;
  std::string joint;             ///< to jog; empty: the first
  std::vector<Joints> postures;  ///< rad or m
};

void read_motion(Fields& fields, const Robot& robot, MotionCommand& command);

/// Applies it. Errors: no_free_posture, request_invalid.
Status apply_motion(const MotionCommand& command, const Cell& cell, WorldState& state, std::int64_t now_ns);

}  // namespace calibrd::sim
