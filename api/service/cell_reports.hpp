// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "api/service/reports.hpp"
#include "core/cross_check/cross_check.hpp"
#include "core/obstacles/find_obstacles.hpp"

namespace calibrd::api {

/// What one sensor sees beside robot and remembered background.
struct SensorObstacles {
  std::string sensor_id;
  std::string code;    ///< why nothing could be looked for, stable: "pose_not_valid", …; empty: it was
  std::string reason;  ///< in words, and what to do
  std::optional<Clock::time_point> stamp;   ///< exposure of the frame, which its joints are interpolated to
  std::vector<double> joint_positions_rad;  ///< of that moment
  Seconds age{0};
  std::string calibration_id;
  std::optional<Pose> T_base_sensor;
  std::vector<Obstacle> obstacles;  ///< nearest to the robot first
};

struct ObstaclesReport {
  std::string base_frame;
  std::vector<std::string> links;  ///< names, by Obstacle::link
  std::vector<SensorObstacles> sensors;
};

struct MergedCloudRequest {
  bool with_robot = true;  ///< false: points on the robot's surface are left out
};

/// Points of all sensors that have a valid pose, base frame, depth corrected for each sensor's known bias.
struct MergedCloud {
  struct Part {
    std::string sensor_id;
    std::string calibration_id;
    Pose T_base_sensor;
    Clock::time_point stamp;                  ///< exposure of the frame, and of its joints
    std::vector<double> joint_positions_rad;  ///< of that moment; empty where they are not known
    std::size_t points = 0;
  };
  struct LeftOut {
    std::string sensor_id, code, reason;
  };
  std::string base_frame;
  std::vector<Part> parts;              ///< a point's sensor is an index into them
  std::vector<LeftOut> left_out;        ///< sensors without a valid pose, frame or joints
  std::vector<Eigen::Vector3f> points;  ///< m, part by part
};

/// Whether two sensors see the cell at the same place.
struct SensorPair {
  std::string first_id, second_id;
  bool compared = false;  ///< both have a valid pose and know their background
  CrossCheck check;       ///< of the second against the first
};

/// Calibrations of several sensors from one motion of the robot.
struct CellCalibrationRequest {
  std::vector<std::string> sensor_ids;  ///< empty: all
  CalibrationRequest each;              ///< but for its sensor_id
};

struct CellCalibrations {
  struct Refused {
    std::string sensor_id;
    Error error;
  };
  std::vector<CalibrationReport> started;
  std::vector<Refused> refused;
};

}  // namespace calibrd::api
