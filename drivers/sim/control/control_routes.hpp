// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "drivers/sim/control/live_world.hpp"
#include "drivers/sim/controller/controller_server.hpp"
#include "drivers/sim/controller/motion_server.hpp"
#include "drivers/sim/model/fields.hpp"

namespace calibrd::sim {

struct ControlRequest {
  std::string method;  ///< GET, PUT, POST
  std::string target;  ///< path and query
  std::string body;    ///< JSON object, or empty for one without keys
};

struct ControlResponse {
  unsigned status = 200;
  std::string body;  ///< JSON; an error reads {"code": ..., "message": ...}
};

/// The control calls, from request to response, without sockets. Each answers with what it has set.
/// One thread: that of the controller server.
class ControlRoutes {
 public:
  /// Without a motion port `motion` is null.
  ControlRoutes(LiveWorld& world, ControllerServer& controller, MotionServer* motion = nullptr)
      : world_(world), controller_(controller), motion_(motion) {}

  ControlResponse handle(const ControlRequest& request);

 private:
  using Path = std::vector<std::string>;
  using Answer = Result<boost::json::object>;

  Answer route(const ControlRequest& request);
  Answer truth(const std::string& query) const;
  Answer sensor_call(const ControlRequest& request, const Path& path, Fields& fields);
  Answer set_pose(SensorState& sensor, Fields& fields) const;
  Answer knock(SensorState& sensor, Fields& fields) const;
  Answer set_errors(SensorState& sensor, Fields& fields) const;
  Answer set_mode(SensorState& sensor, Fields& fields) const;
  Answer set_motion(Fields& fields);
  Answer set_joint_zeros(Fields& fields);
  Answer set_controller(Fields& fields);
  Answer drop_clients(Fields& fields);
  Answer set_object(const std::string& name, Fields& fields);
  Answer set_person(Fields& fields);
  Answer set_other_robot(Fields& fields);

  LiveWorld& world_;
  ControllerServer& controller_;
  MotionServer* motion_;
};

}  // namespace calibrd::sim
