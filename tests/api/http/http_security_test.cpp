// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <mutex>

#include "api/http/http_server.hpp"
#include "api/routes/routes.hpp"
#include "tests/api/fake_cell.hpp"
#include "tests/api/fake_operations.hpp"
#include "tests/api/http/client.hpp"

namespace calibrd::api {
namespace {

using namespace std::chrono_literals;

class Names : public Authenticator {
 public:
  std::optional<Caller> find(std::string_view token) override {
    if (const auto scope = scope_named(token)) return Caller{"the " + std::string(token) + "er", *scope};
    return std::nullopt;
  }
};

class HttpSecurity : public ::testing::Test {
 protected:
  void SetUp() override {
    HttpServerSettings settings;
    settings.port = 0;
    settings.door.authenticator = std::make_shared<Names>();
    settings.audit = [this](const AuditRecord& record) {
      const std::lock_guard lock(mutex_);
      audit_.push_back(record);
    };
    server_ = *HttpServer::start(settings, router_);
  }
  static std::string post(const std::string& path, const std::string& token,
                          const std::string& rest = "\r\n") {
    return "POST " + path + " HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer " + token + "\r\n" + rest;
  }

  FakeCell cell_;
  EventHub events_{"run"};
  FakeOperations operations_;
  Router router_ = make_routes(cell_, events_, operations_);
  std::mutex mutex_;
  std::vector<AuditRecord> audit_;  // guarded by mutex_
  std::unique_ptr<HttpServer> server_;
};

constexpr const char* kCalibrations = "/api/v1/sensors/kinect2/calibrations";

TEST_F(HttpSecurity, AConnectionOutlivesARefusalWithoutABody) {
  Client client(server_->port());
  const auto refused = client.get("/api/v1/cell");
  EXPECT_EQ(refused.result_int(), 401U);
  EXPECT_EQ(refused[http::field::www_authenticate], "Bearer realm=\"calibrd\"");
  client.send("GET /api/v1/cell HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer read\r\n\r\n");
  EXPECT_EQ(client.receive().result_int(), 200U);
}

TEST_F(HttpSecurity, ABodyIsNotWaitedForNorAskedForFromWhoMayNotComeIn) {
  for (const auto* expect : {"", "Expect: 100-continue\r\n"}) {
    Client client(server_->port());
    client.send(post(kCalibrations, "read", std::string(expect) + "Content-Length: 2\r\n\r\n"));
    EXPECT_EQ(client.receive().result_int(), 403U);
  }
}

TEST_F(HttpSecurity, ARefusalIsReadWholeThoughMuchMoreWasSent) {
  Client client(server_->port());
  client.send(post(kCalibrations, "read", "Content-Length: 60000\r\n\r\n" + std::string(60'000, 'x')));
  EXPECT_EQ(client.receive().result_int(), 403U);
  Client header(server_->port());
  header.send("GET / HTTP/1.1\r\nX: " + std::string(1 << 20, 'x'));
  EXPECT_EQ(header.receive().result_int(), 431U);
}

TEST_F(HttpSecurity, ChangesAreAuditedBeforeTheyAreAnsweredAndNothingElseIs) {
  Client client(server_->port());
  client.send(post(kCalibrations, "calibrate"));
  const auto started = client.receive();
  EXPECT_EQ(started.result_int(), 202U);
  {
    const std::lock_guard lock(mutex_);
    ASSERT_EQ(audit_.size(), 1U);
    EXPECT_EQ(audit_[0].who, "the calibrateer");
    EXPECT_EQ(audit_[0].address, "127.0.0.1");
    EXPECT_EQ(audit_[0].method + audit_[0].path, std::string("POST") + kCalibrations);
    EXPECT_EQ(audit_[0].status, 202);
    EXPECT_EQ(audit_[0].location, started[http::field::location]);
  }
  client.send("GET /api/v1/cell HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer read\r\n\r\n");
  EXPECT_EQ(client.receive().result_int(), 200U);
  client.send(post(kCalibrations, "read"));
  EXPECT_EQ(client.receive().result_int(), 403U);
  const std::lock_guard lock(mutex_);
  EXPECT_EQ(audit_.size(), 1U) << "nothing was changed";
}

TEST_F(HttpSecurity, ReadinessInDetailIsNotForEverybody) {
  Client client(server_->port());
  EXPECT_NE(client.get("/readyz").result_int(), 401U);
  EXPECT_EQ(client.get("/readyz?verbose").result_int(), 401U);
  EXPECT_EQ(client.get("/livez").result_int(), 200U);
  client.send("GET /readyz?verbose HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer read\r\n\r\n");
  EXPECT_NE(client.receive().result_int(), 401U);
}

TEST_F(HttpSecurity, AChunkedBodyIsReadAndItsTrailersAreNot) {
  Client client(server_->port());
  client.send(post(kCalibrations, "calibrate",
                   "Content-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n"
                   "f\r\n{\"postures\": 3}\r\n0\r\nContent-Type: text/plain\r\n\r\n"));
  EXPECT_EQ(client.receive().result_int(), 202U);
  client.send("GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(client.receive().result_int(), 200U);
}

}  // namespace
}  // namespace calibrd::api
