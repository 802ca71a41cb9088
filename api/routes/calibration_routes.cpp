// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>
#include <charconv>
#include <functional>

#include "api/json/strict_object.hpp"
#include "api/routes/cell_json.hpp"
#include "api/routes/responses.hpp"
#include "api/routes/routes.hpp"
#include "core/geometry/pose_numbers.hpp"

namespace calibrd::api {
namespace {

namespace json = boost::json;

constexpr int kMaxPostures = 50;
constexpr int kMaxPage = 100;
constexpr std::size_t kMaxIdempotencyKey = 128;
const std::initializer_list<std::string> kCellKeys{"sensors", "method", "postures", "activate"};

Result<Method> read_method(const json::object& body) {
  const auto text = read_text(body, "method", 32);
  if (!text) return text.error();
  if (!*text || **text == "full") return Method::full;
  if (**text == "paper") return Method::paper;
  return fail(ApiError::bad_value, "method: \"" + **text + "\" is neither \"full\" nor \"paper\"");
}

/// "guess": null asks for a search from nothing; without the key the cell chooses the start.
bool asks_for_no_guess(const json::object& body) {
  const auto* guess = body.if_contains("guess");
  return guess && guess->is_null();
}

/// A guess as a list of numbers, or as an object that holds it as T_base_sensor.
Result<std::optional<Pose>> read_guess(const json::object& body) {
  const auto* guess = body.if_contains("guess");
  if (!guess || guess->is_null()) return std::optional<Pose>();
  if (const auto* object = guess->if_object()) {
    const auto* unit = object->if_contains("unit");  // as the answers that hold a pose have it
    if (unit && *unit != "m")
      return fail(ApiError::bad_value, "guess: metres are wanted, unit must be \"m\"");
    guess = object->if_contains("T_base_sensor");
  }
  const auto numbers = guess ? flat_numbers(*guess) : std::nullopt;
  if (!numbers) return fail(ApiError::bad_value, "guess: a list of 7, 12 or 16 numbers is wanted");
  const auto pose = pose_of_numbers(*numbers);
  if (!pose) return fail(ApiError::bad_value, "guess: " + pose.error().message());
  return std::optional<Pose>(*pose);
}

Result<std::string> read_idempotency_key(const Request& request) {
  const auto& key = request.header("idempotency-key");
  const bool printable = std::all_of(key.begin(), key.end(), [](char c) { return c > 0x20 && c < 0x7f; });
  if (key.size() > kMaxIdempotencyKey || !printable) return fail(ApiError::bad_idempotency_key);
  if (key.empty() && request.headers.contains("idempotency-key")) return fail(ApiError::bad_idempotency_key);
  return key;
}

/// `known`: the keys that the body may hold.
Result<CalibrationRequest> read_calibration_request(const Request& request, const std::string& sensor_id,
                                                    std::initializer_list<std::string> known) {
  const auto body = read_body(request.body, request.header("content-type"), known);
  if (!body) return body.error();
  const auto method = read_method(*body);
  if (!method) return method.error();
  const auto guess = read_guess(*body);
  if (!guess) return guess.error();
  const auto postures = read_int(*body, "postures", 1, kMaxPostures);
  if (!postures) return postures.error();
  const auto activate = read_bool(*body, "activate", true);
  if (!activate) return activate.error();
  const auto key = read_idempotency_key(request);
  if (!key) return key.error();
  return CalibrationRequest{sensor_id, *method,   *guess, asks_for_no_guess(*body),
                            *postures, *activate, *key,   json::serialize(*body)};
}

Response answer_start(const Request& request, const PathValues& values, CellService& service) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  const auto wanted =
      read_calibration_request(request, values[0], {"method", "guess", "postures", "activate"});
  if (!wanted) return problem(wanted.error());
  const auto started = service.start_calibration(*wanted);
  if (!started) return problem(started.error());
  auto response = json_response(202, calibration_json(*started, true));
  response.headers.emplace_back("Location", "/api/v1/calibrations/" + started->id);
  response.headers.emplace_back("Retry-After", "1");
  return response;
}

/// Ids under "sensors"; none: all.
Result<std::vector<std::string>> read_sensor_ids(const Request& request) {
  const auto body = read_body(request.body, request.header("content-type"), kCellKeys);
  if (!body) return body.error();
  std::vector<std::string> ids;
  const auto* list = body->if_contains("sensors");
  if (!list || list->is_null()) return ids;
  const auto wrong = fail(ApiError::bad_value, "sensors: a list of sensor ids is wanted, each once");
  if (!list->is_array() || list->get_array().empty()) return wrong;
  for (const auto& id : list->get_array()) {
    const auto* text = id.if_string();
    if (!text || std::ranges::find(ids, std::string(*text)) != ids.end()) return wrong;
    ids.emplace_back(*text);
  }
  return ids;
}

Response answer_start_all(const Request& request, CellService& service) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  const auto ids = read_sensor_ids(request);
  if (!ids) return problem(ids.error());
  const auto each = read_calibration_request(request, {}, kCellKeys);
  if (!each) return problem(each.error());
  const auto calibrations = service.start_calibrations({*ids, *each});
  if (!calibrations) return problem(calibrations.error());
  json::array started, refused;
  for (const auto& calibration : calibrations->started) {
    auto entry = calibration_json(calibration, false);
    entry["location"] = "/api/v1/calibrations/" + calibration.id;
    started.push_back(std::move(entry));
  }
  for (const auto& [id, error] : calibrations->refused)
    refused.push_back({{"sensor", id},
                       {"code", problem_entry(static_cast<ApiError>(error.code.value())).code},
                       {"reason", error.message()}});
  auto response =
      json_response(202, json::object{{"calibrations", std::move(started)}, {"refused", std::move(refused)}});
  response.headers.emplace_back("Retry-After", "1");
  return response;
}

using CalibrationCall = std::function<Result<CalibrationReport>(const std::string& id)>;

Response answer_one(const Request& request, const PathValues& values, const CalibrationCall& call) {
  if (auto unknown = unknown_query(request, {})) return problem(*unknown);
  const auto calibration = call(values[0]);
  return calibration ? json_response(200, calibration_json(*calibration, true))
                     : problem(calibration.error());
}

Result<HistoryQuery> read_history_query(const Request& request, const std::string& sensor_id) {
  if (auto unknown = unknown_query(request, {"limit", "before"})) return *unknown;
  HistoryQuery query{sensor_id, 20, {}};
  if (const auto limit = request.query.find("limit"); limit != request.query.end()) {
    const auto& text = limit->second;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), query.limit);
    if (failure != std::errc() || end != text.data() + text.size() || query.limit < 1 ||
        query.limit > kMaxPage)
      return fail(ApiError::bad_query,
                  "limit: a whole number from 1 to " + std::to_string(kMaxPage) + " is wanted");
  }
  if (const auto before = request.query.find("before"); before != request.query.end())
    query.before = before->second;
  return query;
}

Response answer_history(const Request& request, const PathValues& values, CellService& service) {
  const auto query = read_history_query(request, values[0]);
  if (!query) return problem(query.error());
  const auto page = service.history(*query);
  if (!page) return problem(page.error());
  json::array list;
  for (const auto& calibration : page->calibrations) list.push_back(calibration_json(calibration, false));
  json::object body{{"calibrations", std::move(list)}, {"next", nullptr}};
  if (page->more)
    body["next"] = "/api/v1/sensors/" + query->sensor_id +
                   "/calibrations?limit=" + std::to_string(query->limit) +
                   "&before=" + page->calibrations.back().id;
  return json_response(200, body);
}

}  // namespace

void add_calibration_routes(Router& router, CellService& service) {
  router.add("POST", "/api/v1/sensors/{id}/calibrations", Scope::calibrate, Cost::slow,
             [&service](const Request& request, const PathValues& values) {
               return answer_start(request, values, service);
             });
  router.add("GET", "/api/v1/sensors/{id}/calibrations", Scope::read, Cost::slow,
             [&service](const Request& request, const PathValues& values) {
               return answer_history(request, values, service);
             });
  router.add(
      "POST", "/api/v1/cell/calibrations", Scope::calibrate, Cost::slow,
      [&service](const Request& request, const PathValues&) { return answer_start_all(request, service); });
  const auto add_one = [&router](const char* method, const char* path, Scope scope, CalibrationCall call) {
    router.add(method, path, scope, Cost::slow,
               [call = std::move(call)](const Request& request, const PathValues& values) {
                 return answer_one(request, values, call);
               });
  };
  add_one("GET", "/api/v1/calibrations/{id}", Scope::read,
          [&](const auto& id) { return service.calibration(id); });
  add_one("DELETE", "/api/v1/calibrations/{id}", Scope::calibrate,
          [&](const auto& id) { return service.cancel_calibration(id); });
  add_one("POST", "/api/v1/calibrations/{id}/activate", Scope::calibrate,
          [&](const auto& id) { return service.activate_calibration(id); });
}

}  // namespace calibrd::api
