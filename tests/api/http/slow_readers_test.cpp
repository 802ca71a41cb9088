// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "api/http/http_server.hpp"
#include "tests/api/http/client.hpp"

namespace calibrd::api {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMiB = 1024 * 1024;

/// A server with one large answer, and clients that ask for it and read nothing.
class SlowReadersTest : public ::testing::Test {
 protected:
  SlowReadersTest() {
    router_.add("GET", "/large", Scope::open, Cost::quick, [](const Request&, const PathValues&) {
      return Response{200, {}, std::string(8 * kMiB, 'x')};
    });
    router_.add("GET", "/small", Scope::open, Cost::quick, [](const Request&, const PathValues&) {
      return Response{200, {}, "small"};
    });
  }

  void start(HttpServerSettings settings = {}) {
    settings.port = 0;
    auto started = HttpServer::start(settings, router_, {}, &watch_);
    ASSERT_TRUE(started) << started.error().message();
    server_ = *std::move(started);
  }
  std::unique_ptr<Client> reader() {
    auto client = std::make_unique<Client>(server_->port(), 4096);
    client->send("GET /large HTTP/1.1\r\nHost: localhost\r\n\r\n");
    return client;
  }
  std::int64_t unread() const { return watch_.unread_bytes.value(); }
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
  for (int i = 0; i < 3; ++i) EXPECT_EQ(client.get("/large").body(), std::string(8 * kMiB, 'x'));
  EXPECT_TRUE(comes([&] { return unread() == 0; }));
}

TEST_F(SlowReadersTest, TheKernelTakesLittleOfAnAnswerThatNobodyReads) {
  start();
  const auto client = reader();
  ASSERT_TRUE(comes([&] { return unread() > 0; }));
  std::this_thread::sleep_for(100ms);
  server_.reset();  // what the kernel has it still delivers
  EXPECT_LT(client->receive_all().size(), kMiB);
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
  settings.write_timeout = 100ms;
  start(settings);
  const auto client = reader();
  ASSERT_TRUE(comes([&] { return unread() > 0; }));
  EXPECT_TRUE(comes([&] { return unread() == 0 && watch_.connections.value() == 0; }));
}

TEST_F(SlowReadersTest, HoldNoMoreThanTheLimitAndOthersAreServed) {
  HttpServerSettings settings;
  settings.most_unread = 20 * kMiB;
  start(settings);
  std::vector<std::unique_ptr<Client>> readers;
  for (int i = 0; i < 10; ++i) readers.push_back(reader());
  EXPECT_TRUE(comes([&] { return watch_.connections.value() == 2; })) << watch_.connections.value();
  EXPECT_LE(unread(), static_cast<std::int64_t>(20 * kMiB));
  Client client(server_->port());
  EXPECT_EQ(client.get("/small").body(), "small");
  EXPECT_EQ(client.get("/large").body().size(), 8 * kMiB);
}

}  // namespace
}  // namespace calibrd::api
