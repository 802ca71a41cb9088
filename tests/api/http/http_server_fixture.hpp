// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include "api/http/http_server.hpp"
#include "api/routes/routes.hpp"
#include "tests/api/fake_cell.hpp"
#include "tests/api/fake_operations.hpp"
#include "tests/api/http/client.hpp"

namespace calibrd::api {

/// A server with all routes of a cell that a test plays.
class HttpServerTest : public ::testing::Test {
 protected:
  void start(HttpServerSettings settings = {}) {
    settings.port = 0;
    auto started = HttpServer::start(
        settings, router_, [this](const AccessRecord& record) { log_.push_back(record); }, &watch_);
    ASSERT_TRUE(started) << started.error().message();
    server_ = *std::move(started);
  }

  FakeCell cell_;
  EventHub events_{"run"};
  FakeOperations operations_;
  Router router_ = make_routes(cell_, events_, operations_);
  std::vector<AccessRecord> log_;
  HttpWatch watch_;
  std::unique_ptr<HttpServer> server_;
};

}  // namespace calibrd::api
