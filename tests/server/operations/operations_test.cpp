// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/operations.hpp"

#include <gtest/gtest.h>

#include "api/routes/routes.hpp"
#include "tests/api/fake_cell.hpp"

namespace calibrd {
namespace {

class OperationsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    operations_.pulse().add("http", operations_.http_watch().network_thread);
    operations_.http_watch().network_thread.beat();
    operations_.begin(cell_, events_, router_);
  }

  api::FakeCell cell_;
  api::EventHub events_{"run"};
  Operations operations_{
      {"9.8.7", "[server]\nkey = \"s1\"\n", "/nowhere/c.db", "/nowhere/captures", {}, {"kinect2"}}};
  api::Router router_ = api::make_routes(cell_, events_, operations_);
};

TEST_F(OperationsTest, EveryDocumentedMetricIsThereOnce) {
  const auto text = operations_.metrics();
  for (const auto& family : api::metric_table()) {
    const auto type = std::string("# TYPE ") + family.name + " " + api::name_of(family.type) + "\n";
    const auto first = text.find(type);
    EXPECT_NE(first, std::string::npos) << family.name;
    EXPECT_EQ(text.find(type, first + 1), std::string::npos) << family.name << " is there twice";
  }
  EXPECT_EQ(text.back(), '\n');
}

TEST_F(OperationsTest, FiguresOfTheProcessAreThoseOfTheKernel) {
  const auto text = operations_.metrics();
  const auto value = [&](const std::string& name) {
    const auto at = text.find("\n" + name + " ");
    return at == std::string::npos ? -1.0 : std::stod(text.substr(at + name.size() + 2));
  };
  EXPECT_GT(value("process_resident_memory_bytes"), 1e6);
  EXPECT_GE(value("process_threads"), 1);
  EXPECT_GE(value("process_open_fds"), 3);
  EXPECT_GT(value("process_max_fds"), value("process_open_fds"));
  EXPECT_GE(value("process_cpu_seconds_total"), 0);
  const auto now = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  EXPECT_NEAR(value("process_start_time_seconds"), now, 300);
}

TEST_F(OperationsTest, CountsListenersAsLongAsTheyListen) {
  const auto line = [&] {
    return operations_.metrics().find("\ncalibrd_event_subscribers 1\n") != std::string::npos;
  };
  auto stream = router_.answer({"GET", "/api/v1/events", {}, {}, {}}).stream;
  EXPECT_TRUE(line());
  stream.reset();
  EXPECT_FALSE(line());
}

TEST_F(OperationsTest, TheBundleHoldsAnswersOfTheInterfaceAndNoSecret) {
  const auto tar = operations_.support_bundle().tar;
  for (const auto* part :
       {"calibrd 9.8.7", "/readyz.json", "/metrics.txt", "/cell.json", "/sensors/kinect2/pose.json",
        "/sensors/kinect2/drift.json", "/sensors/kinect2/calibrations.json", "/captures.txt"})
    EXPECT_NE(tar.find(part), std::string::npos) << part;
  EXPECT_EQ(tar.find("s1"), std::string::npos);
}

TEST_F(OperationsTest, TheStatusIsOneLine) {
  EXPECT_EQ(operations_.status(), "robot streaming, kinect2 streaming, its pose uncalibrated, not valid");
}

}  // namespace
}  // namespace calibrd
