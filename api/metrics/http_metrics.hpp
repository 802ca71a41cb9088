// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <chrono>
#include <deque>
#include <string>

#include "api/metrics/metric.hpp"
#include "api/metrics/metrics_text.hpp"
#include "api/routes/router.hpp"

namespace calibrd::api {

/// Statuses that are counted one by one; any other counts as "other".
inline constexpr std::array kCountedStatuses{200, 201, 202, 204, 206, 304, 400, 401, 403, 404, 405,
                                             406, 408, 409, 413, 415, 421, 422, 429, 431, 500, 503};

/// What the answers of a router were, route by route. note() from any thread, without lock or allocation.
class HttpMetrics {
 public:
  /// Counts for the routes the router has now.
  explicit HttpMetrics(const Router& router);

  /// `route`: its place in Router::routes(), or -1.
  void note(int route, int status, std::chrono::microseconds duration);

  void write(MetricsText& text) const;

 private:
  static constexpr std::array kBounds_s{0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025,
                                        0.05,   0.1,     0.25,   0.5,   1.0,    2.5,   10.0, 60.0};
  struct Figures {
    std::string path, method;
    std::array<Counter, kCountedStatuses.size() + 1> by_status;
    Histogram<kBounds_s.size()> duration{kBounds_s};
  };
  std::deque<Figures> routes_;  // a deque: counters do not move; the last one counts what has no route
};

}  // namespace calibrd::api
