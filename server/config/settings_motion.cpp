// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/config/config_error.hpp"
#include "server/config/section_declarer.hpp"

namespace calibrd {
namespace {

using namespace std::chrono_literals;
using Postures = std::vector<std::vector<double>>;

constexpr double kFarthest_deg = 720;

/// One posture: a list of degrees.
Result<std::vector<double>> read_posture(const Kind<double>& angle, const RawValue& raw) {
  const auto* list = std::get_if<std::vector<RawValue>>(&raw.data);
  if (!list || list->empty())
    return Error{ConfigError::bad_value,
                 "each posture is a list of joint positions; write [[0, 20, …], [10, 25, …]]"};
  std::vector<double> posture;
  for (const auto& element : *list) {
    const auto value = angle.read(element);
    if (!value) return value.error();
    posture.push_back(*value);
  }
  return posture;
}

Kind<Postures> postures() {
  const auto angle = real(-kFarthest_deg, kFarthest_deg);
  return {"list of lists of numbers",
          [angle](const RawValue& raw) -> Result<Postures> {
            const auto* list = std::get_if<std::vector<RawValue>>(&raw.data);
            if (!list || list->empty())
              return Error{ConfigError::bad_value,
                           "a list of postures is wanted; write [[0, 20, …], [10, 25, …]]"};
            Postures all;
            for (const auto& element : *list) {
              auto posture = read_posture(angle, element);
              if (!posture) return posture.error();
              all.push_back(*std::move(posture));
            }
            return all;
          },
          [angle](const Postures& all) {
            std::string text;
            for (const auto& posture : all) {
              std::string one;
              for (const double value : posture) one += (one.empty() ? "" : ", ") + angle.write(value);
              text += (text.empty() ? "[" : ", [") + one + "]";
            }
            return all.empty() ? std::string() : "[" + text + "]";
          }};
}

void declare_routes(std::vector<Setting>& table) {
  SectionDeclarer<MotionRouteConfig> key(
      table, {"motion", "routes", "*"},
      [](Config& c, const Names& n) -> MotionRouteConfig& { return c.motion.routes[n[0]]; });
  key("postures_deg", &MotionRouteConfig::postures_deg, postures(), "deg",
      "Postures to visit one after the other, each in the order of joint_names of GET /api/v1/robot.")
      .required = true;
}

}  // namespace

void declare_motion(std::vector<Setting>& table) {
  SectionDeclarer<MotionConfig> key(table, {"motion"},
                                    [](Config& c, const Names&) -> MotionConfig& { return c.motion; });
  key("enabled", &MotionConfig::enabled, flag(), "",
      "Lets calibrd move the robot when it is asked to. While false the motion port is never opened. Read "
      "docs/motion.md first.");
  key("port", &MotionConfig::port, integer(1, 65535), "",
      "Motion port of the controller (MotoROS 50240). Connecting there throws out whoever controls the "
      "robot.");
  key("max_speed_deg_s", &MotionConfig::max_speed_deg_s, real(0.1, 20), "deg/s",
      "No joint is commanded faster.");
  key("max_acceleration_deg_s2", &MotionConfig::max_acceleration_deg_s2, real(0.5, 60), "deg/s²",
      "No joint is accelerated more.");
  key("hold", &MotionConfig::hold, duration(0ms, 10min), "",
      "Stay at each posture; long enough for the frames of a calibration.");
  key("path_tolerance_deg", &MotionConfig::path_tolerance_deg, real(0.1, 5), "deg",
      "A joint that is further than this from the commanded path stops the robot.");
  key("table_height_m", &MotionConfig::table_height_m, real(-10, 10), "m",
      "No moving link goes below this height of the base frame; the motion is refused otherwise.");
  declare_routes(table);
}

}  // namespace calibrd
