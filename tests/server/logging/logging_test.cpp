// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/logging/logging.hpp"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <sstream>
#include <thread>

#include "core/base/log_scope.hpp"
#include "server/logging/log_ring.hpp"

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

std::string line_with(std::unique_ptr<spdlog::formatter> formatter) {
  std::ostringstream out;
  spdlog::logger logger("t", std::make_shared<spdlog::sinks::ostream_sink_st>(out));
  logger.set_formatter(std::move(formatter));
  logger.info("x");
  return out.str();
}

TEST(Logging, LinesNameTheRequestAndTheJobTheyBelongTo) {
  {
    const LogScope request({"r1", {}});
    EXPECT_NE(line_with(json_line_formatter()).find(R"("message": "x", "request_id": "r1"})"),
              std::string::npos);
    const LogScope job({"r1", "c\"1"});
    EXPECT_NE(line_with(json_line_formatter()).find(R"("request_id": "r1", "job_id": "c\"1"})"),
              std::string::npos);
    EXPECT_NE(line_with(text_line_formatter()).find("info: x [request r1] [job c\"1]\n"), std::string::npos);
    std::thread([] { EXPECT_EQ(line_with(json_line_formatter()).find("r1"), std::string::npos); }).join();
  }
  EXPECT_NE(line_with(json_line_formatter()).find(R"("message": "x"})"), std::string::npos);
}

TEST(LogRing, KeepsTheNewestLinesWithinItsBounds) {
  const auto ring = std::make_shared<LogRing>();
  spdlog::logger logger("t", ring);
  logger.set_pattern("%v");
  for (int i = 0; i < 1500; ++i) logger.info("line {}", i);
  const auto text = ring->text();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1000);
  EXPECT_TRUE(text.starts_with("line 500\n")) << text.substr(0, 20);
  EXPECT_TRUE(text.ends_with("line 1499\n"));
  for (int i = 0; i < 10; ++i) logger.info("{}", std::string(100'000, 'x'));
  EXPECT_LE(ring->text().size(), 256U * 1024U);
}

}  // namespace
}  // namespace calibrd
