// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/messages/acknowledgement.hpp"

#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>

namespace calibrd::fleet {
namespace {

namespace json = boost::json;

const json::array* list(const json::object& object, std::string_view key) {
  const auto* value = object.if_contains(key);
  return value ? value->if_array() : nullptr;
}

std::optional<std::string> text(const json::value& value) {
  if (const auto* found = value.if_string()) return std::string(*found);
  return std::nullopt;
}

std::optional<std::string> member(const json::value& value, std::string_view key) {
  const auto* object = value.if_object();
  const auto* found = object ? object->if_contains(key) : nullptr;
  return found ? text(*found) : std::nullopt;
}

}  // namespace

std::string acknowledgement_json(const Acknowledgement& acknowledgement) {
  json::array stored, refused;
  for (const auto& id : acknowledgement.stored) stored.emplace_back(id);
  for (const auto& one : acknowledgement.refused)
    refused.push_back(json::object{{"calibration", one.calibration_id}, {"reason", one.reason}});
  return json::serialize(
      json::object{{"format", "acknowledgement/1"}, {"stored", stored}, {"refused", refused}});
}

std::optional<Acknowledgement> parse_acknowledgement(std::string_view input) {
  boost::system::error_code failure;
  const auto value = json::parse(json::string_view(input.data(), input.size()), failure);
  const auto* object = failure ? nullptr : value.if_object();
  if (!object) return std::nullopt;
  Acknowledgement acknowledgement;
  if (const auto* stored = list(*object, "stored"))
    for (const auto& one : *stored)
      if (auto id = text(one)) acknowledgement.stored.push_back(*std::move(id));
  if (const auto* refused = list(*object, "refused"))
    for (const auto& one : *refused)
      if (auto id = member(one, "calibration"))
        acknowledgement.refused.push_back(
            {*std::move(id), member(one, "reason").value_or("no reason given")});
  return acknowledgement;
}

}  // namespace calibrd::fleet
