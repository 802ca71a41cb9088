// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/simple_message/encode.hpp"

#include <gtest/gtest.h>

#include "tests/drivers/robot/vectors.hpp"

namespace calibrd::simple_message {
namespace {

TEST(Encode, WritesWhatTheReferenceLibraryWrites) {
  for (const GoodVector& vector : good_vectors()) {
    EXPECT_EQ(encode(vector.message, vector.format), vector.bytes) << vector.name;
  }
}

TEST(Encode, TrajectoryPointHasTheSizeOfItsType) {
  const Message point{CommType::service_request, ReplyCode::none, JointTrajectoryPointFull{}};
  EXPECT_EQ(encode(point, {ByteOrder::little, 4}).size(), 16u + 136u);
}

}  // namespace
}  // namespace calibrd::simple_message
