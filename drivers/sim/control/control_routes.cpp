// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/control/control_routes.hpp"

#include <algorithm>
#include <charconv>

#include "drivers/sim/control/truth.hpp"
#include "drivers/sim/model/settings_json.hpp"

namespace calibrd::sim {

namespace json = boost::json;

namespace {

constexpr SimError kInvalid = SimError::request_invalid;

std::vector<std::string> segments(std::string_view path) {
  std::vector<std::string> parts;
  while (!path.empty()) {
    const std::size_t end = std::min(path.find('/'), path.size());
    if (end > 0) parts.emplace_back(path.substr(0, end));
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  return parts;
}

unsigned http_status(const Error& error) {
  if (error.code == make_error_code(SimError::not_found)) return 404;
  if (error.code == make_error_code(SimError::method_not_allowed)) return 405;
  if (error.code == make_error_code(SimError::no_free_posture)) return 409;
  if (error.code == make_error_code(SimError::cannot_listen)) return 409;
  return 400;
}

const char* code_name(unsigned status) {
  switch (status) {
    case 404:
      return "not_found";
    case 405:
      return "method_not_allowed";
    case 409:
      return "conflict";
    default:
      return "request_invalid";
  }
}

/// R = Exp(turn) R, t = t + shift: about the sensor's own origin, in axes of the base.
Eigen::Isometry3d knocked(const Eigen::Isometry3d& pose, const Eigen::Vector3d& turn_rad,
                          const Eigen::Vector3d& shift_m) {
  Eigen::Isometry3d moved = pose;
  if (turn_rad.norm() > 0)
    moved.linear() = Eigen::AngleAxisd(turn_rad.norm(), turn_rad.normalized()) * pose.linear();
  moved.translation() += shift_m;
  return moved;
}

json::object motion_json(const MotionServer& motion) {
  json::object commands;
  for (const auto& [command, count] : motion.commands().counts()) commands[std::to_string(command)] = count;
  return {{"port", motion.port()},
          {"accepted", motion.accepted()},
          {"client", motion.has_client()},
          {"commands", std::move(commands)}};
}

}  // namespace

ControlResponse ControlRoutes::handle(const ControlRequest& request) {
  Answer answer = route(request);
  if (answer) return {200, json::serialize(*answer)};
  const unsigned status = http_status(answer.error());
  return {status,
          json::serialize(json::object{{"code", code_name(status)}, {"message", answer.error().message()}})};
}

ControlRoutes::Answer ControlRoutes::route(const ControlRequest& request) {
  const std::size_t query_at = std::min(request.target.find('?'), request.target.size());
  const Path path = segments(std::string_view(request.target).substr(0, query_at));
  const std::string first = path.empty() ? "" : path[0];
  if (first == "truth" && path.size() == 1) {
    if (request.method != "GET") return sim_error(SimError::method_not_allowed, request.method + " /truth");
    return truth(request.target.substr(query_at));
  }
  auto body = parse_json(request.body.empty() ? "{}" : request.body, "body", kInvalid);
  if (!body) return body.error();
  Fields fields(*body, "", kInvalid);
  if (first == "sensors" && path.size() == 3) return sensor_call(request, path, fields);
  const bool is_drop = path == Path{"controller", "drop"};
  const bool is_known =
      is_drop || (first == "objects" && path.size() == 2) ||
      (path.size() == 1 && (first == "motion" || first == "joint-zeros" || first == "controller" ||
                            first == "person" || first == "other-robot"));
  if (!is_known) return sim_error(SimError::not_found, request.target);
  if (request.method != (is_drop ? "POST" : "PUT"))
    return sim_error(SimError::method_not_allowed, request.method + " " + request.target);
  if (is_drop) return drop_clients(fields);
  if (first == "motion") return set_motion(fields);
  if (first == "joint-zeros") return set_joint_zeros(fields);
  if (first == "controller") return set_controller(fields);
  if (first == "objects") return set_object(path[1], fields);
  return first == "person" ? set_person(fields) : set_other_robot(fields);
}

ControlRoutes::Answer ControlRoutes::truth(const std::string& query) const {
  constexpr std::string_view kAt = "?at_ns=";
  std::int64_t at_ns = monotonic_ns();
  if (!query.empty()) {
    const char* end = query.data() + query.size();
    const bool named = query.starts_with(kAt);
    const auto read = std::from_chars(query.data() + (named ? kAt.size() : 0), end, at_ns);
    if (!named || read.ec != std::errc{} || read.ptr != end)
      return sim_error(kInvalid, query + ": expected ?at_ns= and nanoseconds of CLOCK_MONOTONIC");
  }
  json::object answer = truth_json(world_.cell(), world_.state(), at_ns);
  json::object controller = controller_json(controller_.settings());
  controller["clients"] = controller_.client_count();
  controller["port"] = controller_.port();
  if (motion_ != nullptr) controller["motion"] = motion_json(*motion_);
  answer["controller"] = std::move(controller);
  return answer;
}

ControlRoutes::Answer ControlRoutes::sensor_call(const ControlRequest& request, const Path& path,
                                                 Fields& fields) {
  WorldState state = world_.state();
  const auto end = state.sensors.begin() + state.sensor_count;
  const auto sensor =
      std::find_if(state.sensors.begin(), end, [&](const SensorState& s) { return path[1] == s.id.data(); });
  if (sensor == end) return sim_error(SimError::not_found, "sensor " + path[1]);
  const std::string& call = path[2];
  const bool is_action = call == "knock" || call == "crash";
  if (!is_action && call != "pose" && call != "errors" && call != "mode")
    return sim_error(SimError::not_found, request.target);
  if (request.method != (is_action ? "POST" : "PUT"))
    return sim_error(SimError::method_not_allowed, request.method + " " + request.target);
  if (call == "crash") ++sensor->crashes;
  Answer answer = call == "pose"     ? set_pose(*sensor, fields)
                  : call == "knock"  ? knock(*sensor, fields)
                  : call == "errors" ? set_errors(*sensor, fields)
                  : call == "mode"   ? set_mode(*sensor, fields)
                                     : Answer(json::object{{"crashes", sensor->crashes}});
  if (!answer) return answer;
  if (auto read = fields.finish(); !read) return read.error();
  world_.change(state);
  return answer;
}

ControlRoutes::Answer ControlRoutes::set_pose(SensorState& sensor, Fields& fields) const {
  Eigen::Isometry3d pose = sensor.T_base_sensor.pose();
  read_pose(fields, "T_base_sensor", pose);
  sensor.T_base_sensor = PoseValues::of(pose);
  return json::object{{"T_base_sensor", to_json(pose)}};
}

ControlRoutes::Answer ControlRoutes::knock(SensorState& sensor, Fields& fields) const {
  Eigen::Vector3d turn_deg = Eigen::Vector3d::Zero(), shift_m = Eigen::Vector3d::Zero();
  fields.vector("turn_deg", turn_deg);
  fields.vector("shift_m", shift_m);
  const Eigen::Isometry3d pose = knocked(sensor.T_base_sensor.pose(), turn_deg * (EIGEN_PI / 180), shift_m);
  sensor.T_base_sensor = PoseValues::of(pose);
  return json::object{{"T_base_sensor", to_json(pose)}};
}

ControlRoutes::Answer ControlRoutes::set_errors(SensorState& sensor, Fields& fields) const {
  Fields depth = fields.object("depth"), infrared = fields.object("infrared");
  read_depth_errors(depth, sensor.depth);
  read_infrared_errors(infrared, sensor.infrared);
  fields.number("latency_s", sensor.latency_s, 0, 10);
  for (Fields* part : {&depth, &infrared})
    if (auto read = part->finish(); !read) return read.error();
  return json::object{{"depth", depth_errors_json(sensor.depth)},
                      {"infrared", infrared_errors_json(sensor.infrared)},
                      {"latency_s", sensor.latency_s}};
}

ControlRoutes::Answer ControlRoutes::set_mode(SensorState& sensor, Fields& fields) const {
  int mode = -1;
  fields.choice("mode", {kSensorModes[0], kSensorModes[1], kSensorModes[2], kSensorModes[3], kSensorModes[4]},
                mode);
  if (mode < 0) fields.fail("mode", "one of \"normal\" \"silent\" \"hanging\" \"unplugged\" \"replay\"");
  const auto next = static_cast<SensorMode>(mode);
  if (sensor.mode == SensorMode::unplugged && next == SensorMode::normal) sensor.powered_ns = monotonic_ns();
  sensor.mode = next;
  return json::object{{"mode", mode < 0 ? "" : kSensorModes[mode]}};
}

ControlRoutes::Answer ControlRoutes::set_motion(Fields& fields) {
  MotionCommand command;
  if (!fields.has("mode")) fields.fail("mode", "one of \"run\" \"hold\" \"resume\" \"jog\" \"postures\"");
  read_motion(fields, world_.cell().robot, command);
  if (auto read = fields.finish(); !read) return read.error();
  WorldState state = world_.state();
  const std::int64_t now_ns = monotonic_ns();
  if (auto applied = apply_motion(command, world_.cell(), state, now_ns); !applied) return applied.error();
  world_.change(state);
  return json::object{{"from_ns", std::max(now_ns, state.motion.switch_ns)}};
}

ControlRoutes::Answer ControlRoutes::set_joint_zeros(Fields& fields) {
  WorldState state = world_.state();
  std::vector<double> zeros;
  fields.numbers("joint_zero_rad", zeros, world_.cell().robot.positions.size());
  if (zeros.empty()) fields.fail("joint_zero_rad", "a number for each joint");
  if (auto read = fields.finish(); !read) return read.error();
  std::copy(zeros.begin(), zeros.end(), state.joint_zero_rad.begin());
  world_.change(state);
  return json::object{{"joint_zero_rad", json::array(zeros.begin(), zeros.end())}};
}

ControlRoutes::Answer ControlRoutes::set_controller(Fields& fields) {
  ControllerSettings settings = controller_.settings();
  read_controller(fields, settings);
  if (auto read = fields.finish(); !read) return read.error();
  if (auto applied = controller_.apply(settings); !applied) return applied.error();
  if (motion_ != nullptr) motion_->look_at_settings();
  return controller_json(settings);
}

ControlRoutes::Answer ControlRoutes::drop_clients(Fields& fields) {
  int how = 0;
  fields.choice("how", {"fin", "reset"}, how);
  if (auto read = fields.finish(); !read) return read.error();
  const std::size_t dropped = controller_.client_count();
  controller_.drop_clients(how == 0 ? ControllerServer::Farewell::fin : ControllerServer::Farewell::reset);
  return json::object{{"dropped", dropped}};
}

ControlRoutes::Answer ControlRoutes::set_object(const std::string& name, Fields& fields) {
  const auto& objects = world_.cell().objects;
  const auto found =
      std::find_if(objects.begin(), objects.end(), [&](const Object& o) { return o.name == name; });
  if (found == objects.end()) return sim_error(SimError::not_found, "object " + name);
  WorldState state = world_.state();
  ObjectState& object = state.objects[static_cast<std::size_t>(found - objects.begin())];
  Eigen::Isometry3d pose = object.T_base_object.pose();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  fields.flag("present", object.present);
  fields.vector("shift_m", shift);
  read_pose(fields, "T_base_object", pose);
  pose.translation() += shift;
  object.T_base_object = PoseValues::of(pose);
  if (auto read = fields.finish(); !read) return read.error();
  world_.change(state);
  return json::object{{"name", name}, {"present", object.present != 0}, {"T_base_object", to_json(pose)}};
}

ControlRoutes::Answer ControlRoutes::set_person(Fields& fields) {
  WorldState state = world_.state();
  read_person(fields, state.person, monotonic_ns());
  if (auto read = fields.finish(); !read) return read.error();
  world_.change(state);
  return json::object{{"present", state.person.present != 0}};
}

ControlRoutes::Answer ControlRoutes::set_other_robot(Fields& fields) {
  WorldState state = world_.state();
  OtherRobotState& other = state.other_robot;
  const std::size_t joints = world_.cell().robot.positions.size();
  Eigen::Isometry3d pose = other.T_base_other.pose();
  std::vector<double> posture(other.joints.begin(),
                              other.joints.begin() + static_cast<std::ptrdiff_t>(joints));
  fields.flag("present", other.present);
  fields.numbers("posture_rad", posture, joints);
  read_pose(fields, "T_base_other", pose);
  if (auto read = fields.finish(); !read) return read.error();
  std::copy(posture.begin(), posture.end(), other.joints.begin());
  other.T_base_other = PoseValues::of(pose);
  world_.change(state);
  return json::object{{"present", other.present != 0}, {"T_base_other", to_json(pose)}};
}

}  // namespace calibrd::sim
