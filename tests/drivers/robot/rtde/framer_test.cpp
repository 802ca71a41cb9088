// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/rtde/framer.hpp"

#include <gtest/gtest.h>

#include <random>

#include "drivers/robot/rtde/error.hpp"
#include "tests/drivers/robot/rtde/rtde_bytes.hpp"

namespace calibrd::rtde {
namespace {

using namespace rtde_bytes;

struct Cut {
  std::vector<std::pair<char, Bytes>> packages;
  std::error_code error;
};

void feed(Framer& framer, std::span<const std::byte> piece, Cut& cut) {
  while (!piece.empty() && !cut.error) {
    const auto taken = framer.take(piece);
    if (!taken) {
      cut.error = taken.error().code;
      return;
    }
    if (taken->package)
      cut.packages.emplace_back(taken->package->type,
                                Bytes(taken->package->payload.begin(), taken->package->payload.end()));
    piece = piece.subspan(taken->consumed);
  }
}

const Bytes kStream = handshake() + data() + package('P', number(1, 1)) + package('S');

void expect_whole(const Cut& cut) {
  ASSERT_FALSE(cut.error) << cut.error.message();
  std::string types;
  Bytes rebuilt;
  for (const auto& [type, payload] : cut.packages) {
    types += type;
    rebuilt = rebuilt + package(type, payload);
  }
  EXPECT_EQ(types, "VvOSUPS");
  EXPECT_EQ(rebuilt, kStream);
}

TEST(RtdeFramer, FindsEveryPackageSplitAtEveryByte) {
  for (std::size_t split = 0; split <= kStream.size(); ++split) {
    Framer framer;
    Cut cut;
    feed(framer, std::span(kStream).first(split), cut);
    feed(framer, std::span(kStream).subspan(split), cut);
    expect_whole(cut);
    if (HasFailure()) return;
  }
}

TEST(RtdeFramer, FindsEveryPackageInSingleBytes) {
  Framer framer;
  Cut cut;
  for (std::size_t i = 0; i < kStream.size(); ++i) feed(framer, std::span(kStream).subspan(i, 1), cut);
  expect_whole(cut);
}

TEST(RtdeFramer, RefusesSizesThatNoPackageHas) {
  for (const std::size_t size : {0UL, 1UL, 2UL, kMaxPackageBytes + 1, 0xffffUL}) {
    Framer framer;
    Cut cut;
    feed(framer, number(size, 2) + Bytes(100), cut);
    EXPECT_EQ(cut.error, RtdeError::size_out_of_range) << size;
    feed(framer, accepted('V'), cut);
    EXPECT_TRUE(cut.packages.empty()) << "nothing after the damage can be trusted";
    cut.error.clear();
    framer.reset();
    feed(framer, accepted('V'), cut);
    EXPECT_EQ(cut.packages.size(), 1U);
  }
}

TEST(RtdeFramer, TakesTheLargestPackage) {
  Framer framer;
  Cut cut;
  feed(framer, package('M', Bytes(kMaxPackageBytes - kHeaderBytes)) + package('S'), cut);
  EXPECT_FALSE(cut.error);
  EXPECT_EQ(cut.packages.size(), 2U);
}

TEST(RtdeFramer, KnowsWhenItIsInsideAPackage) {
  Framer framer;
  EXPECT_FALSE(framer.inside_package());
  ASSERT_TRUE(framer.take(number(0, 1)));
  EXPECT_TRUE(framer.inside_package());
  ASSERT_TRUE(framer.take(number(4, 1)));
  ASSERT_TRUE(framer.take(text("S")));
  EXPECT_TRUE(framer.inside_package());
  ASSERT_TRUE(framer.take(number(1, 1)));
  EXPECT_FALSE(framer.inside_package());
}

TEST(RtdeFramer, SurvivesRandomBytes) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> byte(0, 255), length(1, 40);
  for (int round = 0; round < 20000; ++round) {
    Framer framer;
    Cut cut;
    Bytes bytes = number(static_cast<std::uint64_t>(length(random)), 2);
    for (int i = 0; i < 60; ++i) bytes.push_back(static_cast<std::byte>(byte(random)));
    feed(framer, bytes, cut);
    for (const auto& [type, payload] : cut.packages) ASSERT_LE(payload.size(), kMaxPackageBytes);
  }
}

}  // namespace
}  // namespace calibrd::rtde
