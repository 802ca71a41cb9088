// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <future>
#include <thread>

#include "api/http/http_server_error.hpp"
#include "api/routes/responses.hpp"
#include "tests/api/http/http_server_fixture.hpp"

namespace calibrd::api {
namespace {

using namespace std::chrono_literals;

TEST_F(HttpServerTest, ServesManyRequestsOnOneConnection) {
  start();
  Client client(server_->port());
  for (int i = 0; i < 3; ++i) EXPECT_EQ(client.get("/livez").result_int(), 200U);
  const auto pose = client.get("/api/v1/sensors/kinect2/pose");
  EXPECT_EQ(pose.result_int(), 200U);
  EXPECT_EQ(pose[http::field::content_type], "application/json");
  server_.reset();
  ASSERT_EQ(log_.size(), 4U);
  EXPECT_EQ(log_[3].path, "/api/v1/sensors/kinect2/pose");
}

TEST_F(HttpServerTest, ALineBreakInAHeadersValueBeginsNoOther) {
  router_.add("GET", "/odd", Scope::read, Cost::quick, [](const Request&, const PathValues&) {
    Response response;
    response.headers.emplace_back("Location", "/a\r\nSet-Cookie: b");
    return response;
  });
  start();
  const auto answer = Client(server_->port()).get("/odd");
  EXPECT_EQ(answer["Location"], "/a  Set-Cookie: b");
  EXPECT_EQ(answer.count("Set-Cookie"), 0U);
}

TEST_F(HttpServerTest, AnAnswerWithoutABodyHasNoLengthAndTheConnectionGoesOn) {
  router_.add("GET", "/none", Scope::read, Cost::quick, [](const Request&, const PathValues&) {
    return Response{204, {}, "forgotten"};
  });
  start();
  Client client(server_->port());
  EXPECT_EQ(client.get("/none").count(http::field::content_length), 0U);
  EXPECT_EQ(client.get("/livez").result_int(), 200U);
}

TEST_F(HttpServerTest, AnswersPipelinedRequestsInOrder) {
  start();
  Client client(server_->port());
  client.send(
      "GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\nGET /nothing HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(client.receive().result_int(), 200U);
  EXPECT_EQ(client.receive().result_int(), 404U);
}

TEST_F(HttpServerTest, HeadHasLengthAndNoBody) {
  start();
  Client client(server_->port());
  const auto length = client.get("/livez").body().size();
  client.send("HEAD /livez HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const auto head = client.receive(true);
  EXPECT_EQ(head[http::field::content_length], std::to_string(length));
  EXPECT_EQ(client.get("/livez").result_int(), 200U);
}

TEST_F(HttpServerTest, SameEtagIs304WithoutBody) {
  start();
  cell_.make_calibrated();
  Client client(server_->port());
  const auto tag = std::string(client.get("/api/v1/sensors/kinect2/pose")[http::field::etag]);
  client.send("GET /api/v1/sensors/kinect2/pose HTTP/1.1\r\nHost: localhost\r\nIf-None-Match: " + tag +
              "\r\n\r\n");
  EXPECT_EQ(client.receive().result_int(), 304U);
  EXPECT_EQ(client.get("/livez").result_int(), 200U);
}

TEST_F(HttpServerTest, EventsComeAsTheyHappenUntilTheServerEnds) {
  start();
  events_.publish("pose/a", "pose", "{1}");
  Client client(server_->port());
  client.send("GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_NE(client.receive_until("{1}\n\n").find("text/event-stream"), std::string::npos);
  events_.publish("pose/a", "pose", "{2}");
  EXPECT_EQ(client.receive_until("{2}\n\n"), "id: run-2\nevent: pose\ndata: {2}\n\n");
  const auto begin = std::chrono::steady_clock::now();
  server_->stop(5s);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 2s);
  EXPECT_TRUE(client.is_closed());
}

TEST_F(HttpServerTest, AListenerThatGoesAwayGivesItsPlaceBack) {
  HttpServerSettings settings;
  settings.max_connections = 1;
  start(settings);
  {
    Client listener(server_->port());
    listener.send("GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    listener.receive_until("retry");
    EXPECT_EQ(Client(server_->port()).get("/livez").result_int(), 503U);
  }
  for (int i = 0; i < 100; ++i) {  // what is written to a closed connection fails
    events_.publish("pose/a", "pose", std::to_string(i));
    Client client(server_->port());
    if (client.get("/livez").result_int() == 200U) return;
    std::this_thread::sleep_for(20ms);
  }
  FAIL() << "its place is still taken";
}

TEST_F(HttpServerTest, QuickAnswersDoNotWaitForSlowOnes) {
  std::promise<void> release;
  cell_.on_capture = [&](const CaptureRequest&) -> Result<CaptureArchive> {
    release.get_future().wait();
    return CaptureArchive{"a.tar", "x"};
  };
  start();
  Client slow(server_->port()), quick(server_->port());
  slow.send("POST /api/v1/sensors/kinect2/captures HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n");
  EXPECT_EQ(quick.get("/api/v1/sensors/kinect2/pose").result_int(), 200U);
  release.set_value();
  EXPECT_EQ(slow.receive().result_int(), 200U);
}

TEST_F(HttpServerTest, RubbishIsRefusedAndTheConnectionClosed) {
  start();
  for (const auto* rubbish : {"\x16\x03\x01\x02\r\n\r\n", "GET\r\n\r\n",
                              "GET / HTTP/1.1\r\nHost: localhost\r\nbad header\r\n\r\n"}) {
    Client client(server_->port());
    client.send(rubbish);
    EXPECT_EQ(client.receive().result_int(), 400U) << rubbish;
    EXPECT_TRUE(client.is_closed());
  }
}

TEST_F(HttpServerTest, TooLargeHeaderAndBodyAreRefused) {
  start();
  Client header(server_->port());
  header.send("GET /livez HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(9000, 'x') + "\r\n\r\n");
  EXPECT_EQ(header.receive().result_int(), 431U);
  Client body(server_->port());
  body.send(
      "POST /api/v1/sensors/kinect2/calibrations HTTP/1.1\r\nHost: localhost\r\nContent-Length: "
      "70000\r\n\r\n");
  EXPECT_EQ(body.receive().result_int(), 413U);
}

TEST_F(HttpServerTest, ContinuesWhenAskedTo) {
  start();
  Client client(server_->port());
  client.send(
      "POST /api/v1/sensors/kinect2/calibrations HTTP/1.1\r\nHost: localhost\r\nContent-Type: "
      "application/json\r\n"
      "Content-Length: 2\r\nExpect: 100-continue\r\n\r\n");
  EXPECT_EQ(client.receive().result_int(), 100U);
  client.send("{}");
  EXPECT_EQ(client.receive().result_int(), 202U);
}

TEST_F(HttpServerTest, RequestThatTricklesInIsCutOffAtItsDeadline) {
  HttpServerSettings settings;
  settings.header_timeout = 100ms;
  start(settings);
  Client client(server_->port());
  client.send("GET /livez HT");
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_TRUE(client.is_closed());
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 5s);
}

TEST_F(HttpServerTest, ConnectionsBeyondTheLimitAreTold503) {
  HttpServerSettings settings;
  settings.max_connections = 1;
  start(settings);
  Client first(server_->port());
  EXPECT_EQ(first.get("/livez").result_int(), 200U);
  Client second(server_->port());
  EXPECT_EQ(second.receive().result_int(), 503U);
  EXPECT_TRUE(second.is_closed());
  EXPECT_EQ(first.get("/livez").result_int(), 200U);
}

TEST_F(HttpServerTest, StopsAtOnceWithIdleConnectionsOpen) {
  start();
  Client idle(server_->port()), half(server_->port());
  EXPECT_EQ(idle.get("/livez").result_int(), 200U);
  half.send("GET /li");
  const auto begin = std::chrono::steady_clock::now();
  server_->stop();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 800ms);
  EXPECT_TRUE(idle.is_closed());
}

TEST_F(HttpServerTest, RequestUnderWayIsAnsweredBeforeTheEnd) {
  std::promise<void> entered, release;
  cell_.on_capture = [&](const CaptureRequest&) -> Result<CaptureArchive> {
    entered.set_value();
    release.get_future().wait();
    return CaptureArchive{"a.tar", "x"};
  };
  start();
  Client client(server_->port());
  client.send(
      "POST /api/v1/sensors/kinect2/captures HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n");
  entered.get_future().wait();
  auto stopped = std::async(std::launch::async, [&] { server_->stop(10s); });
  release.set_value();
  EXPECT_EQ(client.receive().result_int(), 200U);
  EXPECT_EQ(stopped.wait_for(5s), std::future_status::ready) << "the connection outlived its answer";
}

TEST_F(HttpServerTest, PortInUseIsNamed) {
  start();
  HttpServerSettings settings;
  settings.port = server_->port();
  const auto second = HttpServer::start(settings, router_);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, HttpServerError::port_in_use);
  EXPECT_NE(second.error().message().find(std::to_string(server_->port())), std::string::npos);
}

TEST_F(HttpServerTest, AddressOfAnotherMachineIsNamed) {
  HttpServerSettings settings;
  settings.address = "192.0.2.1";
  EXPECT_EQ(HttpServer::start(settings, router_).error().code, HttpServerError::bad_address);
  settings.address = "localhorst";
  EXPECT_EQ(HttpServer::start(settings, router_).error().code, HttpServerError::bad_address);
}

TEST_F(HttpServerTest, ExceptionInARouteIsAnswered500) {
  cell_.on_start = [](const CalibrationRequest&) -> Result<CalibrationReport> {
    throw std::runtime_error("boom");
  };
  start();
  Client client(server_->port());
  client.send(
      "POST /api/v1/sensors/kinect2/calibrations HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n");
  EXPECT_EQ(client.receive().result_int(), 500U);
  EXPECT_EQ(client.get("/livez").result_int(), 200U);
}

}  // namespace
}  // namespace calibrd::api
