// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// .oni files: recorded by OpenNI2 itself from the fake driver, played by calibrd-sensor.
#include "drivers/sensor/transport/sensor_error.hpp"
#include "tests/drivers/sensor/sensor_test_support.hpp"

namespace calibrd::fake {
namespace {

constexpr int kRecordedFrames = 40;

class RecordingTest : public SensorTest {
 protected:
  void SetUp() override {
    SensorTest::SetUp();
    const std::string command =
        std::string(RECORD_ONI_PROGRAM) + " " + recording() + " " + std::to_string(kRecordedFrames);
    ASSERT_EQ(std::system(command.c_str()), 0);
    write({.devices = 0});  // from here on only the file is there
  }
  std::string recording() const { return directory_ / "recording.oni"; }
  /// Waits for a frame as long as one can come.
  std::optional<DepthFrame> frame_or_end() {
    while (sensor_->health().state != SensorHealth::State::lost)
      if (auto next = sensor_->next(100ms)) return next;
    return sensor_->next(0ms);
  }
  SensorProcessSettings playing() const {
    auto wanted = settings();
    wanted.stream.recording = recording();
    return wanted;
  }
};

TEST_F(RecordingTest, IsPlayedFrameByFrameAndEnds) {
  start(playing());
  int previous = 0, frames = 0, with_image = 0;
  while (const auto received = frame_or_end()) {
    const int index = index_of(received->depth);
    ASSERT_GT(index, previous);
    if (received->image) {
      ++with_image;
      EXPECT_TRUE(is_infrared(*received->image, index));
    }
    previous = index;
    ++frames;
  }
  EXPECT_GE(frames, kRecordedFrames - 5);  // the first ones fall to the time in which the streams start
  EXPECT_GE(with_image, frames - 3);
  ASSERT_TRUE(reach_loss("the recording has ended"));
  EXPECT_EQ(sensor_->health().restarts, 0u);
}

TEST_F(RecordingTest, IsPlayedAgainAndAgain) {
  auto wanted = playing();
  wanted.stream.loop = true;
  start(wanted);
  std::uint64_t last = 0;
  bool has_wrapped = false;
  for (int i = 0, previous = 0; i < 3 * kRecordedFrames; ++i) {
    const auto received = frame();
    ASSERT_TRUE(received);
    const int index = index_of(received->depth);
    has_wrapped = has_wrapped || index < previous;
    EXPECT_TRUE(i == 0 || received->sequence > last);
    last = received->sequence;
    previous = index;
  }
  EXPECT_TRUE(has_wrapped);
  EXPECT_EQ(sensor_->health().restarts, 0u);
}

TEST_F(RecordingTest, IsPlayedAtTheSpeedAskedFor) {
  auto wanted = playing();
  wanted.stream.speed = 0.5;
  start(wanted);
  const auto first = frame();
  auto last = first;
  while (auto received = frame_or_end()) last = std::move(received);
  ASSERT_TRUE(first && last);
  const auto recorded = 10ms * (index_of(last->depth) - index_of(first->depth));
  EXPECT_GT(last->stamp - first->stamp, 1.5 * recorded);
}

TEST_F(RecordingTest, IsRefusedWhenItIsOfAnotherSize) {
  auto wanted = playing();
  wanted.stream.width = 512;
  wanted.stream.height = 424;
  start(wanted);
  EXPECT_TRUE(reach_loss("64x48 at"));
}

TEST_F(SensorTest, SaysThatARecordingCannotBePlayed) {
  auto wanted = settings();
  wanted.stream.recording = "/nonexistent/cell.oni";
  start(wanted);
  EXPECT_TRUE(reach_loss("/nonexistent/cell.oni"));
  EXPECT_NE(sensor_->health().reason.find("cannot be played"), std::string::npos) << sensor_->health().reason;
}

}  // namespace
}  // namespace calibrd::fake
