// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/json/strict_object.hpp"

#include <gtest/gtest.h>

#include "api/problem/api_error.hpp"
#include "core/base/text.hpp"

namespace calibrd::api {
namespace {

constexpr const char* kJson = "application/json; charset=utf-8";

std::error_code failure(const char* body, const char* type = kJson) {
  const auto read = read_body(body, type, {"postures", "method"});
  return read ? std::error_code() : read.error().code;
}

TEST(StrictObject, EmptyBodyIsAnEmptyObject) {
  const auto read = read_body("", "", {"a"});
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->empty());
}

TEST(StrictObject, BadBodiesAreRefusedWithTheirReason) {
  EXPECT_EQ(failure("{}", "text/plain"), ApiError::wrong_content_type);
  EXPECT_EQ(failure("{\"postures\": 3,}"), ApiError::bad_json);
  EXPECT_EQ(failure("{\"postures\": 3"), ApiError::bad_json);
  EXPECT_EQ(failure("{} {}"), ApiError::bad_json);
  EXPECT_EQ(failure("[]"), ApiError::bad_json);
  EXPECT_EQ(failure("{\"posture\": 3}"), ApiError::unknown_key);
  EXPECT_EQ(failure(std::string(40000, '[').c_str()), ApiError::bad_json);
}

TEST(StrictObject, NoBodyIsNestedDeeperThanAnyOfOursNeeds) {
  const auto nested = [](std::size_t depth) {  // the object is one of them
    return R"({"method": )" + std::string(depth - 1, '[') + std::string(depth - 1, ']') + "}";
  };
  EXPECT_FALSE(failure(nested(16).c_str()));
  EXPECT_EQ(failure(nested(17).c_str()), ApiError::bad_json);
}

TEST(StrictObject, KeyThatStandsTwiceIsNamed) {
  const auto read = read_body(R"({"postures": 3, "post\u0075res": 4})", kJson, {"postures", "method"});
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().detail.find("postures: the key stands twice"), std::string::npos)
      << read.error().detail;
  EXPECT_EQ(failure(R"({"method": {"a": 1, "b": [{"a": 2, "a": 3}]}})"), ApiError::bad_value);
  EXPECT_TRUE(read_body(R"({"method": {"a": {"a": 1}, "b": [{"a": 2}, {"a": 3}]}})", kJson, {"method"}));
}

TEST(StrictObject, UnknownKeyNamesTheNearest) {
  const auto read = read_body("{\"posture\": 3}", kJson, {"postures", "method"});
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().detail.find("did you mean 'postures'"), std::string::npos) << read.error().detail;
}

TEST(StrictObject, BrokenJsonNamesLineAndColumn) {
  const auto read = read_body("{\n \"postures\": x}", kJson, {"postures"});
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().detail.find("line 2, column 14"), std::string::npos) << read.error().detail;
}

TEST(StrictObject, ValuesAreCheckedForTypeAndRange) {
  const auto object = *read_body(R"({"postures": 51, "method": 1.5})", kJson, {"postures", "method"});
  EXPECT_FALSE(read_int(object, "postures", 1, 50));
  EXPECT_TRUE(read_int(object, "postures", 1, 51));
  const auto fraction = read_int(object, "method", 1, 50);
  ASSERT_FALSE(fraction);
  EXPECT_NE(fraction.error().detail.find("method: 1.5 is not"), std::string::npos) << fraction.error().detail;
  EXPECT_FALSE(read_bool(object, "method", true));
  EXPECT_FALSE(read_text(object, "method", 10));
  EXPECT_FALSE(*read_int(object, "absent", 1, 2));
}

TEST(StrictObject, WholeNumberMayBeWrittenWithAPoint) {
  const auto object = *read_body(R"({"postures": 5.0, "method": 1e99})", kJson, {"postures", "method"});
  EXPECT_EQ(*read_int(object, "postures", 1, 50), 5);
  EXPECT_FALSE(read_int(object, "method", 1, 50));
}

TEST(StrictObject, WhatIsQuotedInAnErrorIsUtf8) {
  std::string accents;
  for (int i = 0; i < 40; ++i) accents += "\xc3\xa9";
  for (const char* before : {"", "x"}) {  // a cut at an even and at an odd byte
    const auto object = *read_body("{\"method\": \"" + (before + accents) + "\"}", kJson, {"method"});
    EXPECT_TRUE(is_utf8(read_text(object, "method", 10).error().detail));
    EXPECT_TRUE(is_utf8(read_int(object, "method", 1, 2).error().detail));
  }
  EXPECT_TRUE(is_utf8(read_body("{}", "text/\xff", {}).error().detail));
}

TEST(StrictObject, CountsThatCountNothingAreZero) {
  const auto object =
      *read_body(R"({"a": -200, "b": 1e300, "c": 12, "d": 1e999})", kJson, {"a", "b", "c", "d"});
  EXPECT_EQ(count_or_zero(object, "a"), 0U);
  EXPECT_EQ(count_or_zero(object, "b"), 0U);
  EXPECT_EQ(count_or_zero(object, "c"), 12U);
  EXPECT_EQ(count_or_zero(object, "d"), 0U);
}

}  // namespace
}  // namespace calibrd::api
