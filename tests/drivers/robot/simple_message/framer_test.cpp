// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/simple_message/framer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "drivers/robot/simple_message/error.hpp"
#include "tests/drivers/robot/vectors.hpp"

namespace calibrd::simple_message {
namespace {

using Bytes = std::vector<std::byte>;

struct Cut {
  std::vector<Bytes> frames;
  std::error_code error;
};

/// Feeds one piece to the end, or to the first error.
void feed(Framer& framer, std::span<const std::byte> piece, Cut& cut) {
  while (!piece.empty() && !cut.error) {
    const auto taken = framer.take(piece);
    if (!taken) {
      cut.error = taken.error().code;
      return;
    }
    if (taken->frame) cut.frames.emplace_back(taken->frame->begin(), taken->frame->end());
    piece = piece.subspan(taken->consumed);
  }
}

Bytes length_field(std::int32_t length, ByteOrder order) {
  ByteWriter writer({order, 4});
  writer.write_int(length);
  return writer.bytes();
}

std::error_code error_of(const Bytes& bytes, ByteOrder order) {
  Framer framer(order);
  Cut cut;
  feed(framer, bytes, cut);
  return cut.error;
}

TEST(Framer, FindsEveryGoodVectorSplitAtEveryByte) {
  for (const GoodVector& vector : good_vectors()) {
    for (std::size_t split = 0; split <= vector.bytes.size(); ++split) {
      Framer framer(vector.format.byte_order);
      Cut cut;
      feed(framer, std::span(vector.bytes).first(split), cut);
      feed(framer, std::span(vector.bytes).subspan(split), cut);
      ASSERT_FALSE(cut.error) << vector.name << " split at " << split;
      ASSERT_EQ(cut.frames, std::vector<Bytes>{vector.bytes}) << vector.name << " split at " << split;
    }
  }
}

TEST(Framer, FindsEveryGoodVectorInOneStreamOfRandomPieces) {
  std::mt19937 random(20240229);
  for (const ByteOrder order : {ByteOrder::little, ByteOrder::big}) {
    Bytes stream;
    std::vector<Bytes> sent;
    for (const GoodVector& vector : good_vectors()) {
      if (vector.format.byte_order != order) continue;
      sent.push_back(vector.bytes);
      stream.insert(stream.end(), vector.bytes.begin(), vector.bytes.end());
    }
    for (int round = 0; round < 200; ++round) {
      Framer framer(order);
      Cut cut;
      const std::size_t longest = round % 2 ? 7 : 700;
      for (std::span<const std::byte> rest(stream); !rest.empty();) {
        const std::size_t size =
            std::min(rest.size(), std::uniform_int_distribution<std::size_t>(1, longest)(random));
        feed(framer, rest.first(size), cut);
        rest = rest.subspan(size);
      }
      ASSERT_FALSE(cut.error);
      ASSERT_EQ(cut.frames, sent);
      ASSERT_FALSE(framer.inside_frame());
    }
  }
}

TEST(Framer, AcceptsLengthsFrom12To1024Only) {
  for (const ByteOrder order : {ByteOrder::little, ByteOrder::big}) {
    for (const std::int32_t good : {12, 13, 1023, 1024})
      EXPECT_FALSE(error_of(length_field(good, order), order));
    for (const std::int32_t bad : {0, 1, 11, 1025, 2000, 0x7fffffff, -1, -12, INT32_MIN + 1}) {
      EXPECT_EQ(error_of(length_field(bad, order), order), SimpleMessageError::length_out_of_range) << bad;
    }
  }
}

TEST(Framer, RejectsALengthBeforeItTakesAnyOfTheBody) {
  Framer framer(ByteOrder::big);
  EXPECT_FALSE(framer.take(length_field(2000, ByteOrder::big)));
}

TEST(Framer, NamesTheByteOrderToConfigure) {
  Framer big(ByteOrder::big);
  const auto from_little = big.take(length_field(144, ByteOrder::little));
  ASSERT_FALSE(from_little);
  EXPECT_EQ(from_little.error().message(),
            "peer sends little endian, big is configured: set robot.byte_order = \"little\"");
  Framer little(ByteOrder::little);
  const auto from_big = little.take(length_field(144, ByteOrder::big));
  ASSERT_FALSE(from_big);
  EXPECT_EQ(from_big.error().message(),
            "peer sends big endian, little is configured: set robot.byte_order = \"big\"");
}

TEST(Framer, DoesNotGuessTheByteOrderAgainInsideAStream) {
  Bytes stream = good_vectors().front().bytes;
  const Bytes swapped = length_field(144, ByteOrder::big);
  stream.insert(stream.end(), swapped.begin(), swapped.end());
  EXPECT_EQ(error_of(stream, ByteOrder::little), SimpleMessageError::length_out_of_range);
}

TEST(Framer, StaysBrokenUntilReset) {
  Framer framer(ByteOrder::big);
  EXPECT_FALSE(framer.take(length_field(0, ByteOrder::big)));
  EXPECT_FALSE(framer.take(length_field(12, ByteOrder::big)));
  framer.reset();
  EXPECT_TRUE(framer.take(length_field(12, ByteOrder::big)));
}

TEST(Framer, KnowsWhetherAFrameIsUnderWay) {
  Framer framer(ByteOrder::little);
  EXPECT_FALSE(framer.inside_frame());
  const Bytes ping = length_field(12, ByteOrder::little);
  (void)framer.take(std::span(ping).first(1));
  EXPECT_TRUE(framer.inside_frame());
  (void)framer.take(std::span(ping).subspan(1));
  EXPECT_TRUE(framer.inside_frame());
  (void)framer.take(Bytes(12));
  EXPECT_FALSE(framer.inside_frame());
}

}  // namespace
}  // namespace calibrd::simple_message
