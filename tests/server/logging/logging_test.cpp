// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/logging/logging.hpp"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <sstream>

namespace calibrd {
namespace {

TEST(Logging, WritesOneEscapedJsonObjectPerLine) {
  std::ostringstream out;
  spdlog::logger logger("t", std::make_shared<spdlog::sinks::ostream_sink_st>(out));
  logger.set_formatter(json_line_formatter());
  logger.warn("said \"no\"\nand \\ left");
  const auto line = out.str();
  EXPECT_NE(line.find(R"("level": "warning", "message": "said \"no\"\u000aand \\ left"})"), std::string::npos)
      << line;
  EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1);
  EXPECT_EQ(line.substr(0, 12), "{\"time\": \"20");
}

}  // namespace
}  // namespace calibrd
