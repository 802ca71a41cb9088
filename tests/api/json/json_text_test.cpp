// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/json/json_text.hpp"

#include <gtest/gtest.h>

#include <boost/json/parse.hpp>
#include <cmath>

namespace calibrd::api {
namespace {

namespace json = boost::json;

TEST(JsonText, WritesNumbersShortAndListsOnOneLine) {
  const json::value value = {{"a", 0.1}, {"b", {1.0, -2.5e-7, 3}}, {"c", json::array{}}, {"d", nullptr}};
  EXPECT_EQ(json_text(value),
            "{\n  \"a\": 0.1,\n  \"b\": [1, -2.5e-07, 3],\n  \"c\": [],\n  \"d\": null\n}\n");
}

TEST(JsonText, NumbersThatAreNotFiniteBecomeNull) {
  EXPECT_EQ(json_text(json::array{NAN, INFINITY}), "[null, null]\n");
}

TEST(JsonText, ReadsBackTheSame) {
  const json::value value = {{"text", "q\" \n é"}, {"nested", {{{"x", 1.0 / 3}}, {{"y", true}}}}};
  EXPECT_EQ(json::parse(json_text(value)), value);
}

}  // namespace
}  // namespace calibrd::api
