// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/storage/evidence_rows.hpp"

#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <boost/json/value_from.hpp>
#include <boost/json/value_to.hpp>

namespace calibrd {
namespace {

namespace json = boost::json;

std::string views_text(const api::Evidence& evidence) {
  json::array views;
  for (const auto& view : evidence.views)
    views.push_back(
        {{"stamp_s", view.stamp_s}, {"joint_positions_rad", json::value_from(view.joint_positions_rad)}});
  return json::serialize(
      json::object{{"joint_names", json::value_from(evidence.joint_names)}, {"views", std::move(views)}});
}

void parse_views(const std::string& text, api::Evidence& evidence) {
  const auto value = json::parse(text);
  evidence.joint_names = json::value_to<std::vector<std::string>>(value.at("joint_names"));
  for (const auto& view : value.at("views").as_array())
    evidence.views.push_back({view.at("stamp_s").to_number<double>(),
                              json::value_to<std::vector<double>>(view.at("joint_positions_rad"))});
}

}  // namespace

Status insert_evidence(Database& database, const std::string& calibration_id, const api::Evidence& evidence) {
  Statement insert(database,
                   "INSERT INTO evidence (calibration_id, software_version, configuration, views) "
                   "VALUES (?, ?, ?, ?)");
  insert.bind(calibration_id).bind(evidence.software_version).bind(evidence.configuration);
  insert.bind(views_text(evidence)).next();
  return insert.status(StorageError::cannot_write);
}

Result<std::optional<api::Evidence>> select_evidence(Database& database, const std::string& calibration_id) {
  Statement query(database,
                  "SELECT software_version, configuration, views FROM evidence WHERE calibration_id = ?");
  query.bind(calibration_id);
  std::optional<api::Evidence> evidence;
  std::string views;
  if (query.next()) {
    evidence.emplace(api::Evidence{query.text(0), query.text(1), {}, {}});
    views = query.text(2);
  }
  if (auto status = query.status(StorageError::cannot_read); !status) return status.error();
  try {
    if (evidence) parse_views(views, *evidence);
  } catch (const boost::system::system_error& failure) {
    return Error{StorageError::damaged, "evidence of " + calibration_id + ": " + failure.what()};
  }
  return evidence;
}

}  // namespace calibrd
