// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/drift_verdict.hpp"

namespace calibrd {

const char* name_of(DriftVerdict verdict) {
  switch (verdict) {
    case DriftVerdict::in_place:
      return "in_place";
    case DriftVerdict::sensor_moved:
      return "sensor_moved";
    case DriftVerdict::something_in_front:
      return "something_in_front";
    case DriftVerdict::scene_changed:
      return "scene_changed";
    case DriftVerdict::robot_model_wrong:
      return "robot_model_wrong";
    case DriftVerdict::depth_bias_changed:
      return "depth_bias_changed";
    case DriftVerdict::no_evidence:
      break;
  }
  return "no_evidence";
}

const char* text_of(DriftVerdict verdict) {
  switch (verdict) {
    case DriftVerdict::in_place:
      return "the sensor sees the cell as when it was calibrated";
    case DriftVerdict::sensor_moved:
      return "the sensor has moved: its pose is wrong until it is calibrated again";
    case DriftVerdict::something_in_front:
      return "something passes between the sensor and what it knows";
    case DriftVerdict::scene_changed:
      return "something in the cell was moved, brought or taken away; the sensor stands";
    case DriftVerdict::robot_model_wrong:
      return "the sensor stands, but the robot is not where its joints say: check joint zeros, the tool, the "
             "robot's base and the model";
    case DriftVerdict::depth_bias_changed:
      return "the sensor stands, but its range reads otherwise than when it was calibrated, as while it "
             "warms up; calibrate again once it is warm if depths are used as they come";
    case DriftVerdict::no_evidence:
      break;
  }
  return "nothing in view tells whether the sensor stands: neither robot nor enough of the known background "
         "is seen, the sensor is dark, or one thing alone has shifted";
}

}  // namespace calibrd
