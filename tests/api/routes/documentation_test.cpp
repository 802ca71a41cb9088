// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "api/problem/api_error.hpp"

namespace calibrd::api {
namespace {

TEST(Documentation, NamesEveryErrorCode) {
  std::stringstream page;
  page << std::ifstream(CALIBRD_SOURCE_DIR "/docs/api.md").rdbuf();
  for (int error = 1; error <= static_cast<int>(ApiError::internal); ++error) {
    const std::string code = problem_entry(static_cast<ApiError>(error)).code;
    EXPECT_NE(page.str().find("`" + code + "`"), std::string::npos) << code;
  }
}

TEST(Problems, EachHasAnEntryOfItsOwnWithARemedy) {
  std::set<std::string> codes;
  for (int error = 1; error <= static_cast<int>(ApiError::internal); ++error) {
    const auto& entry = problem_entry(static_cast<ApiError>(error));
    EXPECT_TRUE(codes.insert(entry.code).second) << entry.code;
    EXPECT_GE(entry.status, 400);
    EXPECT_NE(std::string(entry.remedy), "");
  }
}

}  // namespace
}  // namespace calibrd::api
