// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace calibrd::api {

enum class MetricType { counter, gauge, histogram };

/// One metric with all its labels: what the page of metrics and docs/metrics.md are both made from.
struct MetricFamily {
  const char* name;
  MetricType type;
  const char* labels;  ///< names, parted by ", "; empty: none
  const char* help;
};

/// Every metric there is, in the order of docs/metrics.md.
std::span<const MetricFamily> metric_table();

/// The row of this name; nothing for another name.
const MetricFamily* find_metric(std::string_view name);

const char* name_of(MetricType type);

/// docs/metrics.md.
std::string metrics_reference();

}  // namespace calibrd::api
