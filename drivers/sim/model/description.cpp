// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/model/description.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "drivers/sim/model/robot_file.hpp"
#include "drivers/sim/model/settings_json.hpp"
#include "drivers/sim/world/random.hpp"

namespace calibrd::sim {
namespace {

namespace json = boost::json;

constexpr SimError kInvalid = SimError::description_invalid;

Status read_robot_part(Fields fields, const std::filesystem::path& folder, const DescriptionOptions& options,
                       World& world, std::int64_t now_ns) {
  std::string urdf;
  RobotFileOptions file_options{options.models, ""};
  double albedo = 0.55, texture = 0.1;
  std::vector<double> posture;
  fields.text("urdf", urdf);
  fields.text("base_link", file_options.base_link);
  fields.number("albedo", albedo, 0, 1);
  fields.number("texture", texture, 0, 1);
  fields.numbers("posture_rad", posture, 0);
  if (auto read = fields.finish(); !read) return read;
  auto robot = read_robot(options.urdf.empty() ? folder / urdf : options.urdf, file_options);
  if (!robot) return robot.error();
  world.cell.robot = std::move(*robot);
  paint(world.cell.robot, albedo, texture);
  const std::size_t joints = world.cell.robot.positions.size();
  world.state.joint_count = static_cast<std::int32_t>(joints);
  Joints start{};
  if (!posture.empty() && posture.size() != joints)
    return sim_error(kInvalid, "robot.posture_rad: expected " + std::to_string(joints) + " numbers");
  std::copy(posture.begin(), posture.end(), start.begin());
  world.state.motion.place(start, now_ns);
  return Done{};
}

Status read_object(Fields fields, World& world) {
  const std::int32_t index = world.state.object_count;
  if (index >= kMaxObjects) return sim_error(SimError::too_large, "objects");
  Object object;
  ObjectState& state = world.state.objects[static_cast<std::size_t>(index)];
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  std::vector<double> box, cylinder;
  double albedo = 0.5, texture = 0.2;
  fields.text("name", object.name);
  fields.numbers("box_m", box, 3);
  fields.numbers("cylinder_m", cylinder, 2);
  fields.number("albedo", albedo, 0, 1);
  fields.number("texture", texture, 0, 1);
  fields.flag("present", state.present);
  read_pose(fields, "T_base_object", pose);
  if (object.name.empty()) fields.fail("name", "a name");
  if (box.empty() == cylinder.empty()) fields.fail("box_m", "either box_m or cylinder_m");
  if (auto read = fields.finish(); !read) return read;
  object.mesh = box.empty() ? make_cylinder(cylinder[0], cylinder[1]) : make_box(Eigen::Vector3d(box.data()));
  object.surface = {static_cast<float>(albedo), static_cast<float>(texture),
                    static_cast<std::uint32_t>(index + 100)};
  state.T_base_object = PoseValues::of(pose);
  world.cell.objects.push_back(std::move(object));
  ++world.state.object_count;
  return Done{};
}

Status read_sensor(Fields fields, World& world, std::int64_t now_ns) {
  const std::int32_t index = world.state.sensor_count;
  if (index >= kMaxSensors) return sim_error(SimError::too_large, "sensors");
  SensorState& sensor = world.state.sensors[static_cast<std::size_t>(index)];
  std::string id = "sensor" + std::to_string(index);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  fields.text("id", id);
  if (id.empty() || id.size() >= kMaxName) fields.fail("id", "a name of 1 to 47 characters");
  read_pose(fields, "T_base_sensor", pose);
  fields.number("rate_hz", sensor.rate_hz, 0.1, 120);
  fields.number("latency_s", sensor.latency_s, 0, 10);
  Fields camera = fields.object("camera"), depth = fields.object("depth_errors"),
         image = fields.object("infrared");
  read_camera(camera, sensor.camera);
  read_depth_errors(depth, sensor.depth);
  read_infrared_errors(image, sensor.infrared);
  for (Fields* part : {&camera, &depth, &image, &fields})
    if (auto read = part->finish(); !read) return read;
  std::copy(id.begin(), id.end(), sensor.id.begin());
  sensor.T_base_sensor = PoseValues::of(pose);
  sensor.powered_ns = now_ns;
  ++world.state.sensor_count;
  return Done{};
}

template <class ReadOne>
Status read_list(Fields& fields, std::string_view key, ReadOne read_one) {
  const json::value* list = fields.child(key);
  if (list == nullptr) return Done{};
  if (!list->is_array()) return sim_error(kInvalid, fields.path(key) + ": expected a list");
  std::size_t index = 0;
  for (const json::value& element : list->get_array()) {
    const std::string where = fields.path(key) + "[" + std::to_string(index++) + "]";
    if (auto read = read_one(Fields(element, where, kInvalid)); !read) return read;
  }
  return Done{};
}

Status read_other_robot(Fields fields, World& world) {
  OtherRobotState& other = world.state.other_robot;
  if (fields.has("position_m") || fields.has("T_base_other")) other.present = 1;
  fields.flag("present", other.present);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  read_pose(fields, "T_base_other", pose);
  std::vector<double> joints(world.cell.robot.positions.size());
  fields.numbers("posture_rad", joints, joints.size());
  std::copy(joints.begin(), joints.end(), other.joints.begin());
  other.T_base_other = PoseValues::of(pose);
  return fields.finish();
}

Status read_dynamics(Fields& fields, World& world, std::int64_t now_ns) {
  Fields person = fields.object("person"), controller = fields.object("controller"),
         motion = fields.object("motion");
  std::vector<double> zeros(world.cell.robot.positions.size());
  fields.numbers("joint_zero_rad", zeros, zeros.size());
  std::copy(zeros.begin(), zeros.end(), world.state.joint_zero_rad.begin());
  MotionCommand command;
  read_person(person, world.state.person, now_ns);
  read_controller(controller, world.controller);
  read_motion(motion, world.cell.robot, command);
  for (Fields* part : {&person, &controller, &motion})
    if (auto read = part->finish(); !read) return read;
  if (auto read = read_other_robot(fields.object("other_robot"), world); !read) return read;
  return apply_motion(command, world.cell, world.state, now_ns);
}

}  // namespace

void paint(Robot& robot, double albedo, double texture) {
  std::uint32_t seed = 1;
  for (auto& link : robot.links) {
    Random random(seed);
    link.surface = {static_cast<float>(std::clamp(albedo * random.uniform(0.75, 1.25), 0.0, 1.0)),
                    static_cast<float>(texture), seed++};
  }
}

Result<World> parse_description(const std::string& text, const std::filesystem::path& folder,
                                const DescriptionOptions& options) {
  auto value = parse_json(text, "world description", kInvalid);
  if (!value) return value.error();
  const std::int64_t now_ns = monotonic_ns();
  World world;
  Fields fields(*value, "", kInvalid);
  std::string note;
  fields.text("note", note);
  if (auto read = read_robot_part(fields.object("robot"), folder, options, world, now_ns); !read)
    return read.error();
  const auto object = [&](Fields part) { return read_object(std::move(part), world); };
  const auto sensor = [&](Fields part) { return read_sensor(std::move(part), world, now_ns); };
  if (auto read = read_list(fields, "objects", object); !read) return read.error();
  if (auto read = read_list(fields, "sensors", sensor); !read) return read.error();
  if (auto read = read_dynamics(fields, world, now_ns); !read) return read.error();
  if (auto read = fields.finish(); !read) return read.error();
  return world;
}

Result<World> read_description(const std::filesystem::path& path, const DescriptionOptions& options) {
  std::ifstream file(path);
  if (!file) return sim_error(SimError::description_unreadable, path.string());
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  auto world = parse_description(text, path.parent_path(), options);
  if (!world && world.error().code == make_error_code(kInvalid))
    return Error{world.error().code, path.string() + ": " + world.error().detail};
  return world;
}

}  // namespace calibrd::sim
