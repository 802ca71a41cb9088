// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "api/pose_formats/pose_format.hpp"
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

TEST(Documentation, NamesEveryPoseFormatWithItsUnits) {
  std::stringstream page;
  page << std::ifstream(CALIBRD_SOURCE_DIR "/docs/pose_formats.md").rdbuf();
  std::stringstream api;
  api << std::ifstream(CALIBRD_SOURCE_DIR "/docs/api.md").rdbuf();
  for (const auto& format : pose_formats()) {
    const auto name = std::string("`").append(format.name).append("`");
    EXPECT_NE(api.str().find(name), std::string::npos) << name;
    std::string frame = "base";
    if (format.reference == Reference::controller) frame = "controller";
    if (format.reference == Reference::inverse) frame = "**inverse**";
    std::string units = format.length_unit;
    if (format.angle_unit) units += std::string(", ") + format.angle_unit;
    const auto row = "| " + name + " | " + frame + " | " + units + " |";
    EXPECT_NE(page.str().find(row), std::string::npos) << row;
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
