// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <sstream>
#include <thread>

#include "api/http/http_server.hpp"
#include "tests/api/http/client.hpp"

namespace calibrd::api {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMiB = 1024 * 1024;
constexpr std::size_t kAnswer = 8 * kMiB;
constexpr std::size_t kTakenByTheKernel = 60 * 1024;
constexpr std::size_t kBite = 512 * 1024;

/// Bytes that the kernel has for the clients of a port, of closed connections as well.
std::size_t held_by_the_kernel(std::uint16_t port) {
  std::ifstream connections("/proc/net/tcp");
  std::string line;
  std::size_t sum = 0;
  std::getline(connections, line);
  while (std::getline(connections, line)) {
    std::istringstream words(line);
    std::string number, local, remote, state, queues;
    words >> number >> local >> remote >> state >> queues;
    constexpr const char* kListening = "0A";  // its queue is another
    const auto local_port = std::stoul(local.substr(local.find(':') + 1), nullptr, 16);
    if (local_port == port && state != kListening)
      sum += std::stoul(queues.substr(0, queues.find(':')), nullptr, 16);
  }
  return sum;
}

/// A server with one large answer, and clients that ask for it and read nothing.
class SlowReadersTest : public ::testing::Test {
 protected:
  SlowReadersTest() {
    router_.add("GET", "/large", Scope::open, Cost::quick, [](const Request&, const PathValues&) {
      return Response{200, {}, std::string(kAnswer, 'x')};
    });
    router_.add("GET", "/small", Scope::open, Cost::quick, [](const Request&, const PathValues&) {
      return Response{200, {}, "small"};
    });
    router_.add("GET", "/middling", Scope::open, Cost::quick, [](const Request&, const PathValues&) {
      return Response{200, {}, std::string(kTakenByTheKernel, 'x')};
    });
  }

  void start(HttpServerSettings settings = {}) {
    settings.port = 0;
    auto started = HttpServer::start(settings, router_, {}, &watch_);
    ASSERT_TRUE(started) << started.error().message();
    server_ = *std::move(started);
  }
  std::unique_ptr<Client> reader(const std::string& path = "/large") {
    auto client = std::make_unique<Client>(server_->port(), 4096);
    client->send("GET " + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    return client;
  }
  std::int64_t unread() const { return watch_.unread_bytes.value(); }
  std::size_t held() const { return held_by_the_kernel(server_->port()); }
  bool comes(const std::function<bool()>& what) {
    for (int i = 0; i < 500 && !what(); ++i) std::this_thread::sleep_for(10ms);
    return what();
  }

  Router router_;
  HttpWatch watch_;
  std::unique_ptr<HttpServer> server_;
};

TEST_F(SlowReadersTest, ALargeAnswerComesWholeToWhoeverReadsIt) {
  start();
  Client client(server_->port());
  for (int i = 0; i < 3; ++i) EXPECT_EQ(client.get("/large").body(), std::string(kAnswer, 'x'));
  EXPECT_TRUE(comes([&] { return unread() == 0; }));
}

TEST_F(SlowReadersTest, WhoTakesALittleAgainAndAgainIsNotGivenUp) {
  HttpServerSettings settings;
  settings.stall_timeout = 500ms;
  start(settings);
  const auto client = reader();
  std::string text;
  for (int i = 0; i < 8; ++i) {  // longer than the limit, with never as long between two bites
    std::this_thread::sleep_for(150ms);
    text += client->receive_some(kBite);
  }
  EXPECT_EQ(watch_.connections.value(), 1);
  const auto whole = text.find("\r\n\r\n") + 4 + kAnswer;
  text += client->receive_some(whole - text.size());
  EXPECT_EQ(text.size(), whole);
  EXPECT_EQ(text.find_last_not_of('x'), whole - kAnswer - 1);
  client->send("GET /small HTTP/1.1\r\nHost: localhost\r\n\r\n");  // and the connection goes on
  EXPECT_EQ(client->receive().body(), "small");
}

TEST_F(SlowReadersTest, AreForgottenWhenTheyGoAway) {
  start();
  auto client = reader();
  ASSERT_TRUE(comes([&] { return unread() > 0; }));
  client.reset();
  EXPECT_TRUE(comes([&] { return unread() == 0 && watch_.connections.value() == 0; }));
}

TEST_F(SlowReadersTest, TheKernelTakesLittleOfAnAnswerThatNobodyReads) {
  start();
  const auto client = reader();
  ASSERT_TRUE(comes([&] { return unread() > 0; }));
  std::this_thread::sleep_for(100ms);
  EXPECT_GT(held(), 0U);
  EXPECT_LT(held(), kMiB);
}

TEST_F(SlowReadersTest, AreGivenUpWhenTheyTakeNothingForTooLong) {
  HttpServerSettings settings;
  settings.stall_timeout = 100ms;
  start(settings);
  const auto client = reader();
  ASSERT_TRUE(comes([&] { return unread() > 0; }));
  EXPECT_TRUE(comes([&] { return unread() == 0 && watch_.connections.value() == 0; }));
}

TEST_F(SlowReadersTest, AreGivenUpWhenTheyTakeTooLongInAll) {
  HttpServerSettings settings;
  settings.write_timeout = 1s;
  start(settings);
  const auto client = reader();
  ASSERT_TRUE(comes([&] { return unread() > 0; }));
  for (int i = 0; i < 20 && unread() > 0; ++i) {  // 2 s, and never long without a bite
    client->receive_some(kBite / 4);
    std::this_thread::sleep_for(100ms);
  }
  EXPECT_TRUE(comes([&] { return unread() == 0 && watch_.connections.value() == 0; }));
  EXPECT_LT(client->receive_all().size(), kMiB);
}

TEST_F(SlowReadersTest, WhoAreGivenUpLeaveNothingToTheKernel) {
  HttpServerSettings settings;
  settings.stall_timeout = 100ms;
  start(settings);
  const auto client = reader();
  ASSERT_TRUE(comes([&] { return held() > 0; }));
  EXPECT_TRUE(comes([&] { return held() == 0; }));
  client->receive_all();
  EXPECT_TRUE(client->is_closed());  // and they are told
}

TEST_F(SlowReadersTest, WhatTheKernelHasOfAWholeAnswerItDoesNotKeepForEver) {
  HttpServerSettings settings;
  settings.idle_timeout = 100ms;
  settings.write_timeout = 1s;
  start(settings);
  const auto client = reader("/middling");
  ASSERT_TRUE(comes([&] { return held() > 0; }));
  EXPECT_TRUE(comes([&] { return watch_.connections.value() == 0; }));  // as any that asks for nothing more
  EXPECT_TRUE(comes([&] { return held() == 0; }));
}

TEST_F(SlowReadersTest, HoldNoMoreThanTheLimitAndOthersAreServed) {
  HttpServerSettings settings;
  settings.most_unread = 20 * kMiB;
  start(settings);
  std::vector<std::unique_ptr<Client>> readers;
  for (int i = 0; i < 10; ++i) readers.push_back(reader());
  EXPECT_TRUE(comes([&] { return watch_.connections.value() == 2; })) << watch_.connections.value();
  EXPECT_LE(unread(), static_cast<std::int64_t>(20 * kMiB));
  EXPECT_LT(held(), kMiB);
  Client client(server_->port());
  EXPECT_EQ(client.get("/small").body(), "small");
  EXPECT_EQ(client.get("/large").body().size(), kAnswer);
}

}  // namespace
}  // namespace calibrd::api
