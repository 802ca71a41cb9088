// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/request_id.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "api/http/http_server.hpp"
#include "api/routes/routes.hpp"
#include "core/base/log_scope.hpp"
#include "tests/api/fake_cell.hpp"
#include "tests/api/fake_operations.hpp"
#include "tests/api/http/client.hpp"

namespace calibrd::api {
namespace {

TEST(RequestId, IsWhatCanStandInAHeaderAndInALog) {
  EXPECT_TRUE(is_request_id("a"));
  EXPECT_TRUE(is_request_id("Line-4.cell_2"));
  EXPECT_TRUE(is_request_id(std::string(64, 'x')));
  for (const auto& other :
       {std::string(), std::string(65, 'x'), std::string("a b"), std::string("a\nb"), std::string("\"")})
    EXPECT_FALSE(is_request_id(other)) << other;
}

TEST(RequestId, IsAnotherOneEachTime) {
  RequestIds ids, others;
  const auto first = ids.next();
  EXPECT_TRUE(is_request_id(first));
  EXPECT_NE(ids.next(), first);
  EXPECT_NE(others.next(), first);
}

class RequestIdTest : public ::testing::Test {
 protected:
  void SetUp() override {
    cell_.on_start = [this](const CalibrationRequest&) -> Result<CalibrationReport> {
      marked_ = log_marks().request_id;  // what a line written now would be marked with
      return cell_.calibration_report;
    };
    HttpServerSettings settings;
    settings.port = 0;
    auto started = HttpServer::start(
        settings, router_, [this](const AccessRecord&) { logged_ = log_marks().request_id; }, &watch_);
    ASSERT_TRUE(started);
    server_ = *std::move(started);
  }
  http::response<http::string_body> ask(Client& client, const std::string& line, const std::string& header) {
    client.send(line + " HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n" + header + "\r\n");
    return client.receive();
  }

  FakeCell cell_;
  EventHub events_{"run"};
  FakeOperations operations_;
  Router router_ = make_routes(cell_, events_, operations_);
  std::string marked_, logged_;
  HttpWatch watch_;
  std::unique_ptr<HttpServer> server_;
};

TEST_F(RequestIdTest, OfTheClientMarksAnswerAndLog) {
  Client client(server_->port());
  const auto answer = ask(client, "POST /api/v1/sensors/kinect2/calibrations", "X-Request-Id: shift-42\r\n");
  EXPECT_EQ(answer["X-Request-Id"], "shift-42");
  server_.reset();
  EXPECT_EQ(marked_, "shift-42") << "on a worker thread";
  EXPECT_EQ(logged_, "shift-42") << "on the network thread";
  EXPECT_EQ(log_marks().request_id, "");
}

TEST_F(RequestIdTest, IsMadeWhereTheClientBringsNoneThatCanBeUsed) {
  Client client(server_->port());
  const auto made = std::string(ask(client, "GET /livez", "")["X-Request-Id"]);
  EXPECT_TRUE(is_request_id(made));
  const auto instead = std::string(ask(client, "GET /nothing", "X-Request-Id: a b\r\n")["X-Request-Id"]);
  EXPECT_TRUE(is_request_id(instead));
  EXPECT_NE(made, instead);
}

TEST_F(RequestIdTest, IsInAnswersToWhatCannotBeRead) {
  Client client(server_->port());
  client.send("rubbish\r\n\r\n");
  EXPECT_TRUE(is_request_id(std::string(client.receive()["X-Request-Id"])));
  EXPECT_TRUE(client.is_closed());
  server_.reset();
  EXPECT_EQ(watch_.unreadable.value(), 1U);
}

TEST_F(RequestIdTest, TheServerShowsItsConnectionsAndThatItGoesOn) {
  {
    Client client(server_->port());
    ask(client, "GET /livez", "");
    EXPECT_EQ(watch_.connections.value(), 1);
  }
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (watch_.connections.value() > 0 && std::chrono::steady_clock::now() < deadline)
    std::this_thread::yield();  // that the client has gone takes a moment to be heard
  server_.reset();
  EXPECT_EQ(watch_.accepted.value(), 1U);
  EXPECT_EQ(watch_.connections.value(), 0);
  ASSERT_TRUE(watch_.network_thread.age());
  EXPECT_LT(*watch_.network_thread.age(), std::chrono::seconds(5));
}

}  // namespace
}  // namespace calibrd::api
