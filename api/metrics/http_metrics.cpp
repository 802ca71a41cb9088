// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/metrics/http_metrics.hpp"

#include <algorithm>

namespace calibrd::api {

HttpMetrics::HttpMetrics(const Router& router) {
  for (const auto& route : router.routes()) {
    auto& figures = routes_.emplace_back();
    figures.path = path_of(route);
    figures.method = route.method;
  }
  auto& others = routes_.emplace_back();
  others.path = "unmatched";
  others.method = "any";
}

void HttpMetrics::note(int route, int status, std::chrono::microseconds duration) {
  const auto place = static_cast<std::size_t>(route);
  auto& figures = route < 0 || place >= routes_.size() ? routes_.back() : routes_[place];
  const auto* const found = std::lower_bound(kCountedStatuses.begin(), kCountedStatuses.end(), status);
  const bool known = found != kCountedStatuses.end() && *found == status;
  figures
      .by_status[known ? static_cast<std::size_t>(found - kCountedStatuses.begin()) : kCountedStatuses.size()]
      .add();
  figures.duration.add(1e-6 * static_cast<double>(duration.count()));
}

void HttpMetrics::write(MetricsText& text) const {
  text.begin("calibrd_http_requests_total");
  for (const auto& figures : routes_)
    for (std::size_t i = 0; i < figures.by_status.size(); ++i) {
      const auto count = figures.by_status[i].value();
      const auto status = i < kCountedStatuses.size() ? std::to_string(kCountedStatuses[i]) : "other";
      if (count > 0)
        text.add({{"route", figures.path}, {"method", figures.method}, {"status", status}},
                 static_cast<double>(count));
    }
  text.begin("calibrd_http_request_duration_seconds");
  for (const auto& figures : routes_)
    if (std::ranges::any_of(figures.by_status, [](const Counter& counter) { return counter.value() > 0; }))
      text.add({{"route", figures.path}, {"method", figures.method}}, figures.duration);
}

}  // namespace calibrd::api
