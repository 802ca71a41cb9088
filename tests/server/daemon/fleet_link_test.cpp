// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/fleet_link.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/api/fake_cell.hpp"
#include "tests/server/storage/storage_folder.hpp"

namespace calibrd {
namespace {

struct FleetBellTest : testing::Test {
  FleetBellTest() {
    config.mqtt.host = "127.0.0.1";
    config.mqtt.port = 1;  // nobody listens there
    config.mqtt.cell = "cell7";
    auto opened = CalibrationStore::open(folder.path() / "calibrd.db");
    EXPECT_TRUE(opened);
    if (opened) store = *std::move(opened);
  }

  const StorageFolder folder;
  Config config;
  api::FakeCell cell;
  std::unique_ptr<CalibrationStore> store;
  fleet::ExporterWatch watch;
  FleetBell bell;
};

TEST_F(FleetBellTest, CalibrationsMayEndWhileTheLinkComesAndGoes) {
  std::atomic<bool> is_ending = false;
  std::vector<std::thread> calibrations;
  for (int i = 0; i < 2; ++i)
    calibrations.emplace_back([&] {
      while (!is_ending) bell.ring();
    });
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(bell.hang(config, "1.0", cell, *store, watch));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    bell.take_down();
  }
  is_ending = true;
  for (auto& calibration : calibrations) calibration.join();
}

TEST_F(FleetBellTest, WithoutABrokerThereIsNothingToRing) {
  config.mqtt.host.clear();
  EXPECT_TRUE(bell.hang(config, "1.0", cell, *store, watch));
  bell.ring();
  bell.take_down();
}

}  // namespace
}  // namespace calibrd
