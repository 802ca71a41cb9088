// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/metrics/http_metrics.hpp"

#include <gtest/gtest.h>

#include "api/problem/api_error.hpp"

namespace calibrd::api {
namespace {

using namespace std::chrono_literals;

Router two_routes() {
  Router router;
  const auto answer = [](const Request&, const PathValues&) { return Response(); };
  router.add("GET", "/api/v1/sensors/{id}/pose", Scope::read, Cost::quick, answer);
  router.add("GET", "/livez", Scope::read, Cost::quick, answer);
  return router;
}

TEST(HttpMetrics, CountsByTemplateMethodAndStatus) {
  const auto router = two_routes();
  HttpMetrics metrics(router);
  const auto response = router.answer({"GET", "/api/v1/sensors/left/pose", {}, {}, {}});
  metrics.note(response.route, 200, 300us);
  metrics.note(router.answer({"GET", "/api/v1/sensors/right/pose", {}, {}, {}}).route, 200, 300us);
  metrics.note(router.answer({"GET", "/secret/path", {}, {}, {}}).route, 404, 10us);
  metrics.note(0, 299, 10us);
  MetricsText text;
  metrics.write(text);
  const auto written = text.take();
  for (const auto* line :
       {R"(calibrd_http_requests_total{route="/api/v1/sensors/{id}/pose",method="GET",status="200"} 2)",
        R"(calibrd_http_requests_total{route="/api/v1/sensors/{id}/pose",method="GET",status="other"} 1)",
        R"(calibrd_http_requests_total{route="unmatched",method="any",status="404"} 1)",
        R"(_bucket{route="/api/v1/sensors/{id}/pose",method="GET",le="0.00025"} 1)",
        R"(_count{route="/api/v1/sensors/{id}/pose",method="GET"} 3)"})
    EXPECT_NE(written.find(line), std::string::npos) << line << "\n" << written;
  EXPECT_EQ(written.find("secret"), std::string::npos) << "a path that anybody may choose is no label";
  EXPECT_EQ(written.find("livez"), std::string::npos) << "nobody has asked for it";
}

TEST(HttpMetrics, EveryStatusOfTheInterfaceIsCountedByItself) {
  EXPECT_TRUE(std::is_sorted(kCountedStatuses.begin(), kCountedStatuses.end()));
  for (int error = 1; error <= static_cast<int>(ApiError::internal); ++error) {
    const int status = problem_entry(static_cast<ApiError>(error)).status;
    EXPECT_TRUE(std::binary_search(kCountedStatuses.begin(), kCountedStatuses.end(), status)) << status;
  }
}

}  // namespace
}  // namespace calibrd::api
