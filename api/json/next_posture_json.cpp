// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/json/next_posture_json.hpp"

#include <boost/json/array.hpp>

#include "api/json/calibration_result_object.hpp"
#include "api/json/json_text.hpp"

namespace calibrd::api {

namespace json = boost::json;

json::object next_posture_object(const PostureSuggestion& suggestion) {
  const auto& names = suggestion.joint_names;
  const auto& positions = suggestion.positions_rad;
  return {{"joint_names", json::array(names.begin(), names.end())},
          {"positions_rad", json::array(positions.begin(), positions.end())},
          {"expected", json::object{{"sigma_position_m", suggestion.sigma_position_m},
                                    {"sigma_rotation_rad", suggestion.sigma_rotation_rad},
                                    {"robot_pixels", suggestion.robot_pixels}}},
          {"improves", suggestion.improves}};
}

std::string calibration_and_next_posture_json(const CalibrationResult& result, double load_ms,
                                              const std::optional<PostureSuggestion>& suggestion) {
  auto object = calibration_result_object(result);
  object["time_ms"].as_object()["load"] = load_ms;
  object["next_posture"] = suggestion ? json::value(next_posture_object(*suggestion)) : json::value(nullptr);
  return json_text(object);
}

}  // namespace calibrd::api
