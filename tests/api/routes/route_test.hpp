// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>

#include "api/routes/routes.hpp"
#include "tests/api/fake_cell.hpp"
#include "tests/api/fake_operations.hpp"

namespace calibrd::api {

/// Asks the routes over a FakeCell, without sockets.
class RouteTest : public ::testing::Test {
 protected:
  Response ask(const std::string& method, const std::string& target, const std::string& body = {},
               std::map<std::string, std::string> headers = {}) {
    const auto parsed = parse_target(target);
    if (!parsed) throw std::invalid_argument(target);
    if (!body.empty()) headers.emplace("content-type", "application/json");
    last_ = router_.answer({method, parsed->first, parsed->second, std::move(headers), body});
    return last_;
  }
  Response get(const std::string& target, std::map<std::string, std::string> headers = {}) {
    return ask("GET", target, {}, std::move(headers));
  }

  const Router& router() const { return router_; }
  boost::json::object body() const { return boost::json::parse(last_.body).as_object(); }
  std::string code() const { return std::string(body().at("code").as_string()); }
  std::string detail() const { return std::string(body().at("detail").as_string()); }
  std::string header(const std::string& name) const {
    for (const auto& [key, value] : last_.headers)
      if (key == name) return value;
    return {};
  }

  FakeCell cell_;
  EventHub events_{"run"};
  FakeOperations operations_;

 private:
  Router router_ = make_routes(cell_, events_, operations_);
  Response last_;
};

}  // namespace calibrd::api
