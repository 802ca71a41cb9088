// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "api/metrics/metric.hpp"
#include "api/metrics/metric_table.hpp"

namespace calibrd::api {

using Label = std::pair<std::string_view, std::string_view>;
using Labels = std::vector<Label>;

/// Writes metrics in Prometheus's text format 0.0.4. Families must be in the metric table; the samples of one
/// follow its begin().
class MetricsText {
 public:
  /// Throws std::logic_error for a name that is not in the table.
  void begin(std::string_view family);
  void add(const Labels& labels, double value);
  /// One sample for each of `states`: 1 for the one that is, 0 for the others. `labels` without that of the
  /// state.
  void add_states(const Labels& labels, std::string_view label, std::span<const char* const> states,
                  std::string_view now);
  template <std::size_t N>
  void add(const Labels& labels, const Histogram<N>& histogram) {
    std::vector<std::uint64_t> counts;
    for (std::size_t i = 0; i <= N; ++i) counts.push_back(histogram.count(i));
    add_buckets(labels, histogram.bounds_s(), counts, histogram.sum_s());
  }

  std::string take() { return std::move(text_); }

 private:
  void add_buckets(Labels labels, std::span<const double> bounds, std::span<const std::uint64_t> counts,
                   double sum);
  void add_sample(std::string_view name, const Labels& labels, double value);

  std::string text_;
  std::string family_;
};

}  // namespace calibrd::api
