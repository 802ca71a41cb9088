// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/api/routes/route_test.hpp"

namespace calibrd::api {
namespace {

class EventRoutes : public RouteTest {
 protected:
  std::string next(std::map<std::string, std::string> headers = {}) {
    const auto response = get("/api/v1/events", std::move(headers));
    stream_ = response.stream;
    return stream_ ? stream_->next() : "no stream";
  }
  std::shared_ptr<BodyStream> stream_;
};

TEST_F(EventRoutes, EachEventHasIdNameAndData) {
  events_.publish("pose/a", "pose", "{}");
  EXPECT_EQ(next(), "retry: 1000\n\nid: run-1\nevent: pose\ndata: {}\n\n");
  EXPECT_EQ(header("Content-Type"), "text/event-stream");
  EXPECT_EQ(stream_->next(), "");
  events_.publish("pose/a", "pose", "{1}");
  EXPECT_EQ(stream_->next(), "id: run-2\nevent: pose\ndata: {1}\n\n");
}

TEST_F(EventRoutes, AListenerGoesOnWhereItWas) {
  events_.publish("pose/a", "pose", "{1}");
  events_.publish("pose/a", "pose", "{2}");
  EXPECT_EQ(next({{"last-event-id", "run-1"}}), "retry: 1000\n\nid: run-2\nevent: pose\ndata: {2}\n\n");
}

TEST_F(EventRoutes, WhatCannotBeResumedIsSaidSo) {
  events_.publish("pose/a", "pose", "{1}");
  EXPECT_EQ(next({{"last-event-id", "other-1"}}),
            "retry: 1000\n\nevent: reset\ndata: {}\n\nid: run-1\nevent: pose\ndata: {1}\n\n");
}

TEST_F(EventRoutes, JointsComeWithThemWhereTheyAreAskedFor) {
  events_.publish("pose/a", "pose", "{1}");
  const auto both = get("/api/v1/events?joints=true", {{"last-event-id", "run-0"}}).stream;
  const auto first = both->next();
  EXPECT_EQ(
      first.find(
          "retry: 1000\n\nid: run-1\nevent: pose\ndata: {1}\n\nevent: joints\ndata: {\"positions_rad\""),
      0U)
      << first;
  EXPECT_EQ(both->next(), "");
  EXPECT_LT(both->pause(), std::chrono::milliseconds(33));
  EXPECT_EQ(get("/api/v1/events?joints=false").stream->next().find("joints"), std::string::npos);
  get("/api/v1/events?joints=1");
  EXPECT_EQ(code(), "bad_query");
}

}  // namespace
}  // namespace calibrd::api
