// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "api/metrics/metrics_text.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <set>
#include <sstream>

namespace calibrd::api {
namespace {

TEST(MetricsText, WritesAFamilyWithItsHelpAndType) {
  MetricsText text;
  text.begin("calibrd_pose_valid");
  text.add({{"sensor", "kinect2"}}, 1);
  EXPECT_EQ(text.take(),
            "# HELP calibrd_pose_valid 1 while the pose may be used.\n# TYPE calibrd_pose_valid gauge\n"
            "calibrd_pose_valid{sensor=\"kinect2\"} 1\n");
}

TEST(MetricsText, EscapesWhatLabelsMayNotHold) {
  MetricsText text;
  text.begin("calibrd_pose_valid");
  text.add({{"sensor", "a\"b\\c\nd"}}, 0);
  EXPECT_NE(text.take().find(R"({sensor="a\"b\\c\nd"} 0)"), std::string::npos);
}

TEST(MetricsText, WritesNumbersThatAreNone) {
  MetricsText text;
  text.begin("calibrd_uptime_seconds");
  text.add({}, std::numeric_limits<double>::infinity());
  text.add({}, -std::numeric_limits<double>::infinity());
  text.add({}, std::numeric_limits<double>::quiet_NaN());
  const auto written = text.take();
  EXPECT_NE(written.find("_seconds +Inf\ncalibrd_uptime_seconds -Inf\ncalibrd_uptime_seconds NaN\n"),
            std::string::npos);
}

TEST(MetricsText, BucketsOfAHistogramAddUp) {
  Histogram<2> histogram({0.1, 1.0});
  for (const double seconds : {0.05, 0.1, 0.5, 7.0}) histogram.add(seconds);
  MetricsText text;
  text.begin("calibrd_calibration_duration_seconds");
  text.add({{"sensor", "a"}}, histogram);
  const auto written = text.take();
  for (const auto* line :
       {R"(_bucket{sensor="a",le="0.1"} 2)", R"(_bucket{sensor="a",le="1"} 3)",
        R"(_bucket{sensor="a",le="+Inf"} 4)", R"(_sum{sensor="a"} 7.65)", R"(_count{sensor="a"} 4)"})
    EXPECT_NE(written.find("calibrd_calibration_duration_seconds" + std::string(line) + "\n"),
              std::string::npos)
        << written;
}

TEST(MetricsText, RefusesAMetricThatIsNotDocumented) {
  MetricsText text;
  EXPECT_THROW(text.begin("calibrd_unheard_of"), std::logic_error);
}

TEST(MetricTable, NamesFollowTheConventionsOfPrometheus) {
  std::set<std::string> names;
  for (const auto& family : metric_table()) {
    const std::string name = family.name;
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_TRUE(name.starts_with("calibrd_") || name.starts_with("process_")) << name;
    EXPECT_EQ(name.ends_with("_total"), family.type == MetricType::counter) << name;
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"), std::string::npos) << name;
    EXPECT_FALSE(std::string(family.help).empty()) << name;
  }
}

TEST(MetricTable, ReferencePageIsUpToDate) {
  std::stringstream page;
  page << std::ifstream(CALIBRD_SOURCE_DIR "/docs/metrics.md").rdbuf();
  EXPECT_EQ(page.str(), metrics_reference()) << "run: calibrd metrics-reference > docs/metrics.md";
}

}  // namespace
}  // namespace calibrd::api
