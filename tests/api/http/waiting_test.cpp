// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// How long is waited for a change, and for clients.
#include <optional>
#include <thread>

#include "tests/api/http/http_server_fixture.hpp"

namespace calibrd::api {
namespace {

using namespace std::chrono_literals;
using Waiting = HttpServerTest;

TEST_F(Waiting, WaitEndsWhenThePoseChangesOrTheTimeIsUp) {
  cell_.make_calibrated();
  start();
  Client client(server_->port());
  const auto ask = [&](const std::string& tag, const std::string& wait) {
    client.send("GET /api/v1/sensors/kinect2/pose?wait=" + wait +
                " HTTP/1.1\r\nHost: localhost\r\nIf-None-Match: " + tag + "\r\n\r\n");
  };
  const auto tag = std::string(client.get("/api/v1/sensors/kinect2/pose")[http::field::etag]);
  ask(tag, "200ms");
  EXPECT_EQ(client.receive().result_int(), 304U);
  ask(tag, "30s");
  Client other(server_->port());
  EXPECT_EQ(other.get("/livez").result_int(), 200U);
  cell_.set_valid(false);
  EXPECT_EQ(client.receive().result_int(), 200U);
}

TEST_F(Waiting, WhoLeavesWhileItWaitsHoldsNoPlace) {
  cell_.make_calibrated();
  start();
  std::optional<Client> client(server_->port());
  const auto tag = std::string(client->get("/api/v1/sensors/kinect2/pose")[http::field::etag]);
  client->send("GET /api/v1/sensors/kinect2/pose?wait=60s HTTP/1.1\r\nHost: localhost\r\nIf-None-Match: " +
               tag + "\r\n\r\n");
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(watch_.connections.value(), 1);
  client.reset();
  for (int i = 0; i < 250 && watch_.connections.value() > 0; ++i) std::this_thread::sleep_for(20ms);
  EXPECT_EQ(watch_.connections.value(), 0);
}

TEST_F(Waiting, WhoConnectsAndAsksForNothingIsNotWaitedForAsLongAsWhoHasAsked) {
  HttpServerSettings settings;
  settings.header_timeout = 100ms;
  start(settings);
  Client mute(server_->port()), client(server_->port());
  EXPECT_EQ(client.get("/livez").result_int(), 200U);
  EXPECT_TRUE(mute.is_closed());
  EXPECT_EQ(client.get("/livez").result_int(), 200U);
}

}  // namespace
}  // namespace calibrd::api
