// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "api/events/event_hub.hpp"
#include "api/page/page_files.hpp"
#include "api/routes/router.hpp"
#include "api/service/cell_service.hpp"
#include "api/service/operations_service.hpp"

namespace calibrd::api {

/// Every route of the HTTP interface (docs/api.md) over `service`, `events` and `operations`, which must
/// outlive the router, and of the page.
Router make_routes(CellService& service, const EventHub& events, const OperationsService& operations,
                   PageFiles page = {});

// The parts it is made of.
void add_pose_routes(Router& router, CellService& service);
void add_sensor_routes(Router& router, CellService& service);
void add_drift_routes(Router& router, CellService& service);
void add_diff_routes(Router& router, CellService& service);
void add_robot_routes(Router& router, CellService& service);
void add_calibration_routes(Router& router, CellService& service);
void add_several_sensors_routes(Router& router, CellService& service);
void add_obstacle_routes(Router& router, CellService& service);
void add_next_posture_routes(Router& router, CellService& service);
void add_motion_routes(Router& router, CellService& service);
void add_recording_routes(Router& router, CellService& service);
void add_health_routes(Router& router, CellService& service, const OperationsService& operations);
void add_openapi_routes(Router& router);
void add_operations_routes(Router& router, const OperationsService& operations);
void add_frame_routes(Router& router, CellService& service);
void add_event_routes(Router& router, const EventHub& events, const CellService& service);
void add_session_routes(Router& router);
void add_page_routes(Router& router, std::shared_ptr<const PageFiles> files);

}  // namespace calibrd::api
