// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/routes/routes.hpp"

namespace calibrd::api {

Router make_routes(CellService& service, const EventHub& events, const OperationsService& operations,
                   PageFiles page) {
  Router router;
  add_health_routes(router, service, operations);
  add_operations_routes(router, operations);
  add_pose_routes(router, service);
  add_sensor_routes(router, service);
  add_drift_routes(router, service);
  add_robot_routes(router, service);
  add_calibration_routes(router, service);
  add_diff_routes(router, service);
  add_next_posture_routes(router, service);
  add_recording_routes(router, service);
  add_motion_routes(router, service);
  add_several_sensors_routes(router, service);
  add_obstacle_routes(router, service);
  add_frame_routes(router, service);
  add_event_routes(router, events, service);
  add_session_routes(router);
  add_openapi_routes(router);
  add_page_routes(router, std::make_shared<const PageFiles>(std::move(page)));
  return router;
}

}  // namespace calibrd::api
