// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "fleet/messages/topics.hpp"

#include <algorithm>

namespace calibrd::fleet {
namespace {

constexpr std::size_t kLongestName = 64;
constexpr std::string_view kCalibrations = "/calibrations";

std::string cells(const std::string& prefix) { return prefix + "/v1/cells/"; }

}  // namespace

bool is_name(std::string_view text) {
  const auto is_fit = [](unsigned char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' ||
           c == '_' || c == '-';
  };
  return !text.empty() && text.size() <= kLongestName && std::all_of(text.begin(), text.end(), is_fit);
}

CellTopics::CellTopics(const std::string& prefix, const std::string& cell)
    : base_(cells(prefix) + cell + "/") {}

std::string collector_topic(const std::string& prefix) { return prefix + "/v1/collector"; }

std::string every_calibration(const std::string& prefix) {
  return cells(prefix) + "+" + std::string(kCalibrations);
}

std::optional<std::string> cell_of(const std::string& prefix, std::string_view topic) {
  const auto begin = cells(prefix);
  if (!topic.starts_with(begin) || !topic.ends_with(kCalibrations)) return std::nullopt;
  topic.remove_prefix(begin.size());
  if (topic.size() <= kCalibrations.size()) return std::nullopt;
  topic.remove_suffix(kCalibrations.size());
  if (!is_name(topic)) return std::nullopt;
  return std::string(topic);
}

}  // namespace calibrd::fleet
