// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "drivers/sim/control/live_world.hpp"
#include "tests/core/robot/scratch_folder.hpp"
#include "tests/drivers/sim/sim_fixtures.hpp"

namespace calibrd::sim::test {

/// A simulated world that lives beside the test; CALIBRD_SIM_WORLD names it.
class RunningWorld {
 public:
  explicit RunningWorld(const World& world) : world_(world) {
    ::setenv(kWorldVariable, path().c_str(), 1);
    start();
  }
  ~RunningWorld() { stop(); }

  std::filesystem::path path() const { return folder_.path() / "world"; }
  const Cell& cell() const { return world_.cell; }
  WorldState state() {
    const std::lock_guard lock(mutex_);
    return live_->state();
  }
  void change(const std::function<void(WorldState&)>& change) {
    const std::lock_guard lock(mutex_);
    WorldState state = live_->state();
    change(state);
    live_->change(state);
  }
  void set_mode(SensorMode mode) {
    change([&](WorldState& state) { state.sensors[0].mode = mode; });
  }

  void start() {
    auto live = LiveWorld::open(world_, path());
    EXPECT_TRUE(live);
    live_ = std::make_unique<LiveWorld>(std::move(*live));
    beating_ = true;
    beat_ = std::thread([this] {
      while (beating_) {
        {
          const std::lock_guard lock(mutex_);
          live_->beat();
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      }
    });
  }
  void stop() {
    beating_ = false;
    if (beat_.joinable()) beat_.join();
    live_.reset();
  }

 private:
  calibrd::test::ScratchFolder folder_;
  World world_;
  std::mutex mutex_;
  std::unique_ptr<LiveWorld> live_;
  std::atomic<bool> beating_ = false;
  std::thread beat_;
};

}  // namespace calibrd::sim::test
