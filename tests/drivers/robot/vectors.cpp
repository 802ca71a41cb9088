// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/drivers/robot/vectors.hpp"

#include <algorithm>
#include <boost/json.hpp>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace calibrd::simple_message {
namespace {

namespace json = boost::json;

const json::object& file() {
  static const json::value parsed = [] {
    std::ifstream in(CALIBRD_ROBOT_VECTORS);
    if (!in) throw std::runtime_error("cannot read " CALIBRD_ROBOT_VECTORS);
    std::ostringstream text;
    text << in.rdbuf();
    return json::parse(text.str());
  }();
  return parsed.as_object();
}

std::string text(const json::object& from, const char* key) { return from.at(key).as_string().c_str(); }

std::vector<std::byte> bytes_of(const std::string& hex) {
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    bytes.push_back(static_cast<std::byte>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

std::int32_t number(const json::object& values, const char* key) {
  return values.at(key).to_number<std::int32_t>();
}

JointValues joints(const json::object& values, const char* key) {
  JointValues joints{};
  const json::value* found = values.if_contains(key);
  if (!found) return joints;
  std::ranges::transform(found->as_array(), joints.begin(),
                         [](const json::value& v) { return v.to_number<double>(); });
  return joints;
}

JointFeedback feedback(const json::object& values) {
  return {number(values, "robot_id"),  number(values, "valid_fields"), values.at("time").to_number<double>(),
          joints(values, "positions"), joints(values, "velocities"),   joints(values, "accelerations")};
}

RobotStatus status(const json::object& values) {
  return {number(values, "drives_powered"), number(values, "e_stopped"), number(values, "error_code"),
          number(values, "in_error"),       number(values, "in_motion"), number(values, "mode"),
          number(values, "motion_possible")};
}

/// The file states in words what the two groups hold.
JointFeedbackEx two_groups() {
  JointFeedbackEx both;
  both.group_count = 2;
  both.records[0] = {0, 6, 0, {0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7}, {1, -1, 0.5, -0.5, 0.25, -0.25, 0.125},
                     {}};
  both.records[1] = both.records[0];
  both.records[1].robot_id = 1;
  std::swap(both.records[1].positions, both.records[1].velocities);
  return both;
}

Body body(const json::object& values) {
  const std::int32_t type = number(values, "msg_type");
  switch (type) {
    case Ping::kType:
      return Ping{};
    case JointPosition::kType:
      return JointPosition{number(values, "sequence"), joints(values, "joints")};
    case RobotStatus::kType:
      return status(values);
    case JointFeedback::kType:
      return feedback(values);
    case JointFeedbackEx::kType:
      return two_groups();
    case MotionControl::kType:
      return MotionControl{number(values, "group"), number(values, "sequence"), number(values, "command"),
                           joints(values, "data")};
    case MotionReply::kType:
      return MotionReply{number(values, "group"),  number(values, "sequence"), number(values, "command"),
                         number(values, "result"), number(values, "subcode"),  joints(values, "data")};
    default:
      return OtherMessage{type, {}};
  }
}

GoodVector good(const json::object& entry) {
  const json::object& values = entry.at("values").as_object();
  return {text(entry, "name"),
          {text(entry, "order") == "big" ? ByteOrder::big : ByteOrder::little,
           entry.at("real_bytes").to_number<std::size_t>()},
          {CommType{number(values, "comm_type")}, ReplyCode{number(values, "reply")}, body(values)},
          bytes_of(text(entry, "hex"))};
}

}  // namespace

std::vector<GoodVector> good_vectors() {
  std::vector<GoodVector> vectors;
  for (const json::value& entry : file().at("good").as_array()) vectors.push_back(good(entry.as_object()));
  return vectors;
}

std::vector<BadVector> bad_vectors() {
  std::vector<BadVector> vectors;
  for (const json::value& entry : file().at("bad").as_array()) {
    const json::object& bad = entry.as_object();
    vectors.push_back({text(bad, "name"), bytes_of(text(bad, "hex_little")), bytes_of(text(bad, "hex_big"))});
  }
  return vectors;
}

std::vector<std::byte> live_first_cycle(const std::string& name) {
  return bytes_of(text(file().at("live_first_cycle").as_object(), name.c_str()));
}

}  // namespace calibrd::simple_message
