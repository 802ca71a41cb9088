// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "drivers/sensor/sensor_process.hpp"
#include "tests/drivers/sensor/fakes/fake_control.hpp"
#include "tests/drivers/sensor/fakes/test_pattern.hpp"

namespace calibrd::fake {

using namespace std::chrono_literals;

/// Starts sensor processes on the fake driver through the real OpenNI2.
class SensorTest : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = std::filesystem::temp_directory_path() /
                 (std::string("calibrd-") + testing::UnitTest::GetInstance()->current_test_info()->name() +
                  "-" + std::to_string(::getpid()));
    std::filesystem::create_directories(directory_);
    ::setenv(kControlVariable, control_path().c_str(), 1);
    // For the children of sanitized builds: OpenNI2 itself leaks when it ends and locks in varying order.
    ::setenv("ASAN_OPTIONS", "detect_leaks=0", 0);
    ::setenv("TSAN_OPTIONS", "detect_deadlocks=0:report_mutex_bugs=0", 0);
    write(Control{});
  }
  void TearDown() override {
    sensor_.reset();
    std::filesystem::remove_all(directory_);
  }

  std::string control_path() const { return directory_ / "control"; }
  void write(const Control& control) { write_control(control_path(), control); }

  static SensorProcessSettings settings() {
    SensorProcessSettings settings;
    settings.id = "test";
    settings.stream.width = kWidth;
    settings.stream.height = kHeight;
    settings.stream.fps = kFps;
    settings.program = CALIBRD_SENSOR_PROGRAM;
    settings.openni_directory = FAKE_OPENNI_DIRECTORY;
    settings.timeouts.restart_min = 20ms;
    settings.timeouts.restart_max = 100ms;
    return settings;
  }

  void start(const SensorProcessSettings& wanted) {
    auto started = SensorProcess::start(wanted);
    ASSERT_TRUE(started) << started.error().message();
    sensor_ = std::move(*started);
  }

  /// The next frame; fails the test when none comes.
  std::optional<DepthFrame> frame() {
    auto next = sensor_->next(20s);
    EXPECT_TRUE(next) << sensor_->health().reason;
    return next;
  }

  /// Reads frames until the health satisfies `condition`.
  bool reach(const std::function<bool(const SensorHealth&)>& condition) {
    const auto deadline = Clock::now() + 20s;
    while (!condition(sensor_->health())) {
      if (Clock::now() > deadline) return false;
      sensor_->next(10ms);
    }
    return true;
  }
  bool reach_loss(const std::string& reason) {
    const bool is_lost = reach([&](const SensorHealth& health) {
      return health.state == SensorHealth::State::lost && health.reason.find(reason) != std::string::npos;
    });
    EXPECT_TRUE(is_lost) << "want '" << reason << "', have '" << sensor_->health().reason << "'";
    return is_lost;
  }
  bool reach_streaming() {
    return reach([](const SensorHealth& health) { return health.state == SensorHealth::State::streaming; });
  }

  std::filesystem::path directory_;
  std::unique_ptr<SensorProcess> sensor_;
};

/// Which frame of the fake driver this depth image is; -1 when its pixels are not those of one frame.
inline int index_of(const DepthImage& depth) {
  const int index = depth.raw.at(0);
  const int device = depth.raw.at(1) - 1000;
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x)
      if (depth.raw[depth.index(x, y)] != depth_at(index, device, x, y)) return -1;
  return index;
}

inline bool is_infrared(const GreyImage& image, int index) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (image.pixels[static_cast<std::size_t>(y * image.width + x)] != infrared_at(index, x, y))
        return false;
  return true;
}

inline bool is_color(const GreyImage& image, int index) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (image.pixels[static_cast<std::size_t>(y * image.width + x)] != color_at(index, x, y)) return false;
  return true;
}

}  // namespace calibrd::fake
