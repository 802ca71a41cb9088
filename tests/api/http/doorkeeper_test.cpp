// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/http/doorkeeper.hpp"

#include <gtest/gtest.h>

#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>

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

Request asking(std::map<std::string, std::string> headers = {}) {
  headers.emplace("host", "localhost:8080");
  return {"GET", "/", {}, std::move(headers), {}};
}

Request with_token(const std::string& authorization) { return asking({{"authorization", authorization}}); }

/// Status of the refusal; 0: it comes in.
int refused(Doorkeeper& door, Request request, Scope needed = Scope::read, const Peer& peer = {}) {
  const auto refusal = door.refuse(request, needed, peer);
  return refusal ? refusal->status : 0;
}

std::string header(const Response& response, const std::string& name) {
  for (const auto& [key, value] : response.headers)
    if (key == name) return value;
  return {};
}

TEST(Doorkeeper, WithoutTokensEverybodyIsLocalAndMayDoEverything) {
  Doorkeeper door({});
  auto request = asking();
  EXPECT_FALSE(door.refuse(request, Scope::admin, {}));
  EXPECT_EQ(request.caller, "local");
}

TEST(Doorkeeper, AScopeIncludesTheSmallerOnes) {
  DoorSettings settings;
  settings.authenticator = std::make_shared<Names>();
  Doorkeeper door(settings);
  const std::array scopes{Scope::read, Scope::calibrate, Scope::admin};
  for (const auto has : scopes)
    for (const auto needs : scopes)
      EXPECT_EQ(refused(door, with_token(std::string("Bearer ") + name_of(has)), needs),
                has < needs ? 403 : 0)
          << name_of(has) << name_of(needs);
}

TEST(Doorkeeper, TellsWhatIsWrongWithAToken) {
  DoorSettings settings;
  settings.authenticator = std::make_shared<Names>();
  Doorkeeper door(settings);
  auto none = asking();
  EXPECT_EQ(header(*door.refuse(none, Scope::read, {}), "WWW-Authenticate"), "Bearer realm=\"calibrd\"");
  auto unknown = with_token("Bearer s3cret");
  const auto refusal = door.refuse(unknown, Scope::read, {});
  EXPECT_EQ(refusal->status, 401);
  EXPECT_NE(header(*refusal, "WWW-Authenticate").find("invalid_token"), std::string::npos);
  EXPECT_EQ(refusal->body.find("s3cret"), std::string::npos);
  auto small = with_token("bearer  read");
  EXPECT_NE(header(*door.refuse(small, Scope::admin, {}), "WWW-Authenticate").find("scope=\"admin\""),
            std::string::npos);
  for (const auto* other : {"", "Bearer", "Bearer ", "Basic read", "Bearerread", "read"})
    EXPECT_EQ(refused(door, with_token(other)), 401) << other;
}

TEST(Doorkeeper, AnOpenRouteKnowsItsCallerWhereThereIsOne) {
  DoorSettings settings;
  settings.authenticator = std::make_shared<Names>();
  Doorkeeper door(settings);
  auto nobody = asking(), wrong = with_token("Bearer x"), somebody = with_token("Bearer calibrate");
  EXPECT_FALSE(door.refuse(nobody, Scope::open, {}));
  EXPECT_EQ(nobody.granted, Scope::open);
  EXPECT_FALSE(door.refuse(wrong, Scope::open, {}));
  EXPECT_EQ(wrong.granted, Scope::open);
  EXPECT_FALSE(door.refuse(somebody, Scope::open, {}));
  EXPECT_EQ(somebody.granted, Scope::calibrate);
}

TEST(Doorkeeper, ANameThatIsNotOursIsMisdirected) {
  DoorSettings settings;
  settings.hosts = {"Cell7.Example"};
  Doorkeeper door(settings);
  const auto host = [](const char* name) { return Request{"GET", "/", {}, {{"host", name}}, {}}; };
  for (const auto* ours : {"localhost", "LOCALHOST:1", "127.0.0.1:8080", "[::1]", "192.168.1.7",
                           "cell7.example", "cell7.example.:80"})
    EXPECT_EQ(refused(door, host(ours)), 0) << ours;
  for (const auto* foreign :
       {"evil.example", "cell7.example.evil.example", "localhost.evil.example", "1.2.3.4.evil"})
    EXPECT_EQ(refused(door, host(foreign)), 421) << foreign;
  settings.hosts = {"*"};
  Doorkeeper any(settings);
  EXPECT_EQ(refused(any, host("evil.example")), 0);
}

TEST(Doorkeeper, PagesOfOtherSitesAreRefused) {
  DoorSettings settings;
  settings.hosts = {"cell7.example"};
  Doorkeeper door(settings);
  const auto from = [](const char* origin) { return asking({{"origin", origin}}); };
  for (const auto* own :
       {"http://localhost:8080", "http://LOCALHOST:8080", "https://cell7.example", "http://cell7.example:81"})
    EXPECT_EQ(refused(door, from(own)), 0) << own;
  for (const auto* foreign : {"null", "", "http://evil.example", "http://localhost", "http://localhost:3000",
                              "http://localhost:8080.evil.example", "file://", "http://127.0.0.1:8080"})
    EXPECT_EQ(refused(door, from(foreign)), 403) << foreign;
  EXPECT_EQ(refused(door, asking({{"sec-fetch-site", "cross-site"}, {"sec-fetch-mode", "no-cors"}})), 403);
  EXPECT_EQ(refused(door, asking({{"sec-fetch-site", "cross-site"}, {"sec-fetch-mode", "navigate"}})), 0);
  EXPECT_EQ(refused(door, asking({{"sec-fetch-site", "same-origin"}, {"sec-fetch-mode", "cors"}})), 0);
}

TEST(Doorkeeper, TooManyRequestsAreToldWhenToComeBack) {
  DoorSettings settings;
  settings.rate_limit = 2;
  settings.loopback_rate_limit = 0;
  Doorkeeper door(settings);
  const Peer far{"192.0.2.1", "192.0.2.1", false}, here{"127.0.0.1", "loopback", true};
  EXPECT_EQ(refused(door, asking(), Scope::read, far), 0);
  EXPECT_EQ(refused(door, asking(), Scope::read, far), 0);
  auto third = asking();
  const auto refusal = door.refuse(third, Scope::read, far);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->status, 429);
  EXPECT_EQ(header(*refusal, "Retry-After"), "1");
  for (int i = 0; i < 10; ++i) EXPECT_EQ(refused(door, asking(), Scope::read, here), 0);
}

TEST(Doorkeeper, AnAnswerThatGoesOnEndsWhenItsTokenIsRevoked) {
  class Revocable : public Authenticator {
   public:
    std::optional<Caller> find(std::string_view) override {
      return is_there ? std::optional(Caller{"a", Scope::read}) : std::nullopt;
    }
    bool is_there = true;
  };
  DoorSettings settings;
  const auto tokens = std::make_shared<Revocable>();
  settings.authenticator = tokens;
  Doorkeeper door(settings);
  const auto request = with_token("Bearer x");
  EXPECT_TRUE(door.still_admits(request, Scope::read, {}));
  tokens->is_there = false;
  EXPECT_FALSE(door.still_admits(request, Scope::read, {}));
}

TEST(RateLimiter, ABucketFillsAgainAtItsRate) {
  RateLimiter limiter;
  const RateLimiter::Time begin{};
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(limiter.take("a", 10, begin));
  EXPECT_FALSE(limiter.take("a", 10, begin));
  EXPECT_TRUE(limiter.take("b", 10, begin));
  EXPECT_FALSE(limiter.take("a", 10, begin + 90ms));
  EXPECT_TRUE(limiter.take("a", 10, begin + 200ms));
  int taken = 0;
  while (limiter.take("a", 10, begin + 1h)) ++taken;
  EXPECT_EQ(taken, 10) << "more than a second's worth was saved up";
}

TEST(RateLimiter, ItsMemoryHasABound) {
  RateLimiter limiter;
  for (int i = 0; i < 100'000; ++i) EXPECT_TRUE(limiter.take(std::to_string(i), 10, {}));
  EXPECT_LE(limiter.clients(), RateLimiter::kMost);
}

}  // namespace
}  // namespace calibrd::api
