// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/json/calibration_result_json.hpp"

#include <array>
#include <boost/json/parse.hpp>
#include <limits>
#include <utility>

#include "api/json/calibration_result_object.hpp"
#include "api/json/json_text.hpp"
#include "api/json/pose_json.hpp"
#include "api/json/strict_object.hpp"
#include "api/problem/api_error.hpp"
#include "core/geometry/pose_numbers.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

constexpr std::array kVerdicts{std::pair{Verdict::accepted, "accepted"},
                               std::pair{Verdict::uncertain, "uncertain"},
                               std::pair{Verdict::rejected, "rejected"}};

json::array covariance_json(const Matrix6d& covariance) {
  json::array rows;
  for (int r = 0; r < 6; ++r) {
    json::array row;
    for (int c = 0; c < 6; ++c) row.emplace_back(covariance(r, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

json::object depth_correction_json(const DepthCorrection& correction) {
  return {{"scale", correction.scale},
          {"offset_m", correction.offset_m},
          {"periodic_sin_m", correction.periodic_sin_m},
          {"periodic_cos_m", correction.periodic_cos_m},
          {"periodic_period_m", correction.periodic_period_m}};
}

json::array joint_zeros_json(const std::vector<JointZero>& zeros) {
  json::array all;
  for (const auto& zero : zeros)
    all.push_back({{"joint", zero.joint}, {"zero", zero.zero}, {"sigma", zero.sigma}});
  return all;
}

json::array reasons_json(const std::vector<Reason>& reasons) {
  json::array all;
  for (const auto& reason : reasons) all.push_back({{"code", reason.code}, {"text", reason.text}});
  return all;
}

json::array links_json(const std::vector<LinkCoverage>& links) {
  json::array all;
  for (const auto& link : links)
    if (link.predicted > 0)
      all.push_back({{"link", link.link}, {"predicted", link.predicted}, {"coverage", link.coverage}});
  return all;
}

json::array weak_directions_json(const std::vector<WeakDirection>& directions) {
  json::array all;
  for (const auto& weak : directions) {
    const auto& d = weak.direction_base;
    all.push_back({{"what", weak.what},
                   {"kind", weak.is_rotation ? "rotation" : "position"},
                   {"direction", json::array{d.x(), d.y(), d.z()}},
                   {weak.is_rotation ? "sigma_rad" : "sigma_m", weak.sigma}});
  }
  return all;
}

json::array workspace_json(const std::vector<WorkspaceError>& errors) {
  json::array all;
  for (const auto& [point, sigma_m] : errors)
    all.push_back({{"name", point.name},
                   {"x", point.p_base.x()},
                   {"y", point.p_base.y()},
                   {"z", point.p_base.z()},
                   {"sigma_m", sigma_m}});
  return all;
}

/// What was infinite was written as null. Read as 0 it would claim certainty.
double sigma_of(const json::object& object, std::string_view key) {
  return number_or(object, key, std::numeric_limits<double>::infinity());
}

/// 36 numbers, null for an infinite one.
std::optional<Matrix6d> covariance_of(const json::value& rows) {
  if (!rows.is_array() || rows.get_array().size() != 6) return std::nullopt;
  Matrix6d covariance;
  for (int r = 0; r < 6; ++r) {
    const auto* row = rows.get_array()[static_cast<std::size_t>(r)].if_array();
    if (!row || row->size() != 6) return std::nullopt;
    for (int c = 0; c < 6; ++c) {
      const auto& value = (*row)[static_cast<std::size_t>(c)];
      if (!value.is_number() && !value.is_null()) return std::nullopt;
      covariance(r, c) =
          value.is_null() ? std::numeric_limits<double>::infinity() : value.to_number<double>();
    }
  }
  return covariance;
}

/// Calls `take` with each object of an array; what is no array is left aside.
template <class Take>
void for_each_object(const json::object& object, std::string_view key, const Take& take) {
  const auto* value = object.if_contains(key);
  if (!value || !value->is_array()) return;
  for (const auto& entry : value->get_array())
    if (const auto* inner = entry.if_object()) take(*inner);
}

void read_evidence(const json::object& object, CalibrationResult& result) {
  for_each_object(object, "links", [&](const json::object& link) {
    result.links.push_back(
        {text_or(link, "link", ""), count_or_zero(link, "predicted"), number_or(link, "coverage", 0)});
  });
  for_each_object(object, "weak_directions", [&](const json::object& weak) {
    const bool is_rotation = text_or(weak, "kind", "") == "rotation";
    const auto* direction = weak.if_contains("direction");
    const auto d = direction ? flat_numbers(*direction) : std::nullopt;
    if (d && d->size() == 3)
      result.weak_directions.push_back({text_or(weak, "what", ""),
                                        is_rotation,
                                        {(*d)[0], (*d)[1], (*d)[2]},
                                        sigma_of(weak, is_rotation ? "sigma_rad" : "sigma_m")});
  });
  for_each_object(object, "workspace", [&](const json::object& point) {
    result.workspace.push_back(
        {{text_or(point, "name", ""),
          {number_or(point, "x", 0), number_or(point, "y", 0), number_or(point, "z", 0)}},
         sigma_of(point, "sigma_m")});
  });
  if (object.contains("held_out_residual_m"))
    result.held_out_residual_m = number_or(object, "held_out_residual_m", 0);
  if (object.contains("runner_up_margin")) result.runner_up_margin = number_or(object, "runner_up_margin", 0);
}

DepthCorrection depth_correction_of(const json::object& object) {
  DepthCorrection correction;
  correction.scale = number_or(object, "scale", 1);
  correction.offset_m = number_or(object, "offset_m", 0);
  correction.periodic_sin_m = number_or(object, "periodic_sin_m", 0);
  correction.periodic_cos_m = number_or(object, "periodic_cos_m", 0);
  correction.periodic_period_m = number_or(object, "periodic_period_m", 0);
  return correction;
}

void read_joint_zeros(const json::object& object, CalibrationResult& result) {
  const auto* zeros = object.if_contains("joint_zeros");
  if (!zeros || !zeros->is_array()) return;
  for (const auto& zero : zeros->get_array())
    if (const auto* entry = zero.if_object())
      result.joint_zeros.push_back(
          {text_or(*entry, "joint", ""), number_or(*entry, "zero", 0), sigma_of(*entry, "sigma")});
}

Result<CalibrationResult> read_pose_part(const json::object& object, CalibrationResult result) {
  if (const auto* matrix = object.if_contains("T_base_sensor")) {
    const auto numbers = flat_numbers(*matrix);
    if (!numbers) return fail(ApiError::bad_value, "T_base_sensor");
    auto pose = pose_of_numbers(*numbers);
    if (!pose) return fail(ApiError::bad_value, "T_base_sensor: " + pose.error().message());
    result.T_base_sensor = *pose;
  }
  const auto* rows = object.if_contains("covariance");
  const auto covariance = rows ? covariance_of(*rows) : std::nullopt;
  if (!covariance) return fail(ApiError::bad_value, "covariance");
  result.covariance = *covariance;
  return result;
}

void read_reasons(const json::object& object, CalibrationResult& result) {
  const auto* reasons = object.if_contains("reasons");
  if (!reasons || !reasons->is_array()) return;
  for (const auto& reason : reasons->get_array())
    if (const auto* entry = reason.if_object())
      result.reasons.push_back({text_or(*entry, "code", ""), text_or(*entry, "text", "")});
}

json::array hypotheses_json(const std::vector<Hypothesis>& hypotheses) {
  json::array list;
  for (const Hypothesis& hypothesis : hypotheses)
    list.push_back(
        json::object{{"score", hypothesis.score}, {"T_base_sensor", matrix_json(hypothesis.T_base_sensor)}});
  return list;
}

}  // namespace

const char* name_of(Verdict verdict) {
  for (const auto& [value, name] : kVerdicts)
    if (value == verdict) return name;
  return "rejected";
}

const char* name_of(Method method) { return method == Method::full ? "full" : "paper"; }

json::object calibration_result_object(const CalibrationResult& result) {
  json::object object{{"verdict", name_of(result.verdict)}};
  if (result.T_base_sensor && result.verdict != Verdict::rejected)
    object["T_base_sensor"] = matrix_json(*result.T_base_sensor);
  object["covariance"] = covariance_json(result.covariance);
  object["sigma_position_m"] = result.sigma_position_m;
  object["sigma_rotation_rad"] = result.sigma_rotation_rad;
  object["depth_correction"] = depth_correction_json(result.depth_correction);
  object["joint_zeros"] = joint_zeros_json(result.joint_zeros);
  object["residual_rms_m"] = result.residual_rms_m;
  object["coverage"] = result.coverage;
  object["links"] = links_json(result.links);
  if (result.held_out_residual_m) object["held_out_residual_m"] = *result.held_out_residual_m;
  if (result.runner_up_margin) object["runner_up_margin"] = *result.runner_up_margin;
  if (!result.hypotheses.empty()) object["hypotheses"] = hypotheses_json(result.hypotheses);
  object["weak_directions"] = weak_directions_json(result.weak_directions);
  object["workspace"] = workspace_json(result.workspace);
  object["views"] = result.views;
  object["used_guess"] = result.used_guess;
  object["reasons"] = reasons_json(result.reasons);
  object["time_ms"] = json::object{{"total", result.time_total_ms}};
  return object;
}

std::string calibration_result_json(const CalibrationResult& result, std::optional<double> load_ms) {
  auto object = calibration_result_object(result);
  if (load_ms) object["time_ms"].as_object()["load"] = *load_ms;
  return json_text(object);
}

Result<CalibrationResult> parse_calibration_result(const std::string& text) {
  boost::system::error_code failure;
  const auto parsed = json::parse(text, failure);
  const auto* object = failure ? nullptr : parsed.if_object();
  if (!object) return fail(ApiError::bad_json, "stored calibration result");
  CalibrationResult result;
  const auto verdict = text_or(*object, "verdict", "");
  for (const auto& [value, name] : kVerdicts)
    if (verdict == name) result.verdict = value;
  result.sigma_position_m = sigma_of(*object, "sigma_position_m");
  result.sigma_rotation_rad = sigma_of(*object, "sigma_rotation_rad");
  if (const auto* correction = object->if_contains("depth_correction"); correction && correction->is_object())
    result.depth_correction = depth_correction_of(correction->get_object());
  result.residual_rms_m = number_or(*object, "residual_rms_m", 0);
  result.coverage = number_or(*object, "coverage", 0);
  result.views = static_cast<int>(count_or_zero(*object, "views"));
  if (const auto* used = object->if_contains("used_guess"))
    result.used_guess = used->is_bool() && used->get_bool();
  if (const auto* times = object->if_contains("time_ms"); times && times->is_object())
    result.time_total_ms = number_or(times->get_object(), "total", 0);
  read_joint_zeros(*object, result);
  read_reasons(*object, result);
  read_evidence(*object, result);
  return read_pose_part(*object, std::move(result));
}

}  // namespace calibrd::api
