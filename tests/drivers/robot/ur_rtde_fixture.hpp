// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <optional>

#include "drivers/robot/rtde/error.hpp"
#include "drivers/robot/ur_rtde_codec.hpp"
#include "tests/drivers/robot/rtde/rtde_bytes.hpp"

namespace calibrd {

/// A codec whose connection has begun.
class UrRtdeCodecTest : public testing::Test {
 protected:
  UrRtdeCodecTest() { begin({}); }
  void begin(UrRtdeSettings settings) {
    codec_.emplace(std::move(settings));
    EXPECT_EQ(codec_->begin(), rtde_bytes::hex("0005560002"));
  }
  CodecOutput take(const rtde_bytes::Bytes& bytes, Clock::duration after = {}) {
    return codec_->decode(bytes, start_ + after);
  }
  void stream() { ASSERT_FALSE(take(rtde_bytes::handshake()).broken); }
  std::error_code broken_by(const rtde_bytes::Bytes& bytes) {
    const CodecOutput output = take(bytes);
    return output.broken ? output.broken->code : std::error_code();
  }
  std::error_code problem_of(const rtde_bytes::Data& values) {
    const CodecOutput output = take(rtde_bytes::data(values));
    EXPECT_FALSE(output.joints);
    EXPECT_FALSE(output.broken);
    EXPECT_EQ(output.messages, 1U) << "the controller is alive";
    return output.joints_problem ? output.joints_problem->code : std::error_code();
  }
  const Clock::time_point start_{std::chrono::seconds(1000)};
  std::optional<UrRtdeCodec> codec_;
};

}  // namespace calibrd
