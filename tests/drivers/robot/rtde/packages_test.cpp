// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/rtde/packages.hpp"

#include <gtest/gtest.h>

#include "drivers/robot/rtde/error.hpp"
#include "tests/drivers/robot/rtde/rtde_bytes.hpp"

namespace calibrd::rtde {
namespace {

using namespace rtde_bytes;

constexpr std::array<std::string_view, 2> kNames{"timestamp", "actual_q"};

/// The payload of a package as the maker's client library writes or reads it.
Bytes payload(const std::string& digits) { return hex(digits.substr(6)); }

TEST(RtdePackages, RequestsAreThoseOfTheMakersLibrary) {
  EXPECT_EQ(ask_for_protocol(2), hex("0005560002"));
  EXPECT_EQ(ask_for_controller_version(), hex("000376"));
  EXPECT_EQ(ask_for_outputs(2, 125, kNames),
            hex("001d4f405f40000000000074696d657374616d702c61637475616c5f71"));
  EXPECT_EQ(ask_to_start(), hex("000353"));
}

TEST(RtdePackages, ProtocolOneIsAskedWithoutAFrequency) {
  EXPECT_EQ(ask_for_protocol(1), hex("0005560001"));
  EXPECT_EQ(ask_for_outputs(1, 125, kNames), package('O', text("timestamp,actual_q")));
}

TEST(RtdePackages, ReadsTheRepliesOfTheMakersLibrary) {
  EXPECT_TRUE(read_accepted(payload("00045601")).value());
  EXPECT_FALSE(read_accepted(payload("00045600")).value());
  EXPECT_TRUE(read_accepted(payload("00045301")).value());
  const auto version = read_controller_version(payload("0013760000000a0000000b0000000c0000000d"));
  ASSERT_TRUE(version);
  EXPECT_EQ(version->text(), "10.11.12");
  EXPECT_EQ(version->build, 13U);
  const auto setup = read_output_setup(2, payload("00134f01444f55424c452c564543544f523644"));
  ASSERT_TRUE(setup);
  EXPECT_EQ(setup->recipe, 1);
  EXPECT_EQ(setup->types, (std::vector<std::string>{"DOUBLE", "VECTOR6D"}));
  EXPECT_EQ(read_text(2, payload("000e4d0568656c6c6f0363746c02")), "hello");
}

TEST(RtdePackages, TheOutputsOfProtocolOneHaveNoRecipe) {
  const auto setup = read_output_setup(1, text("DOUBLE,NOT_FOUND"));
  ASSERT_TRUE(setup);
  EXPECT_EQ(setup->types, (std::vector<std::string>{"DOUBLE", "NOT_FOUND"}));
}

TEST(RtdePackages, RepliesOfAnotherSizeAreRefused) {
  for (const std::size_t size : {0U, 2U, 17U})
    EXPECT_EQ(read_accepted(Bytes(size)).error().code, RtdeError::wrong_payload_size) << size;
  for (const std::size_t size : {0U, 15U, 17U})
    EXPECT_EQ(read_controller_version(Bytes(size)).error().code, RtdeError::wrong_payload_size) << size;
  EXPECT_EQ(read_output_setup(2, {}).error().code, RtdeError::wrong_payload_size);
  EXPECT_EQ(read_output_setup(1, {}).error().code, RtdeError::wrong_payload_size);
}

TEST(RtdePackages, TypesAreListedAsTheyStand) {
  EXPECT_EQ(read_output_setup(2, number(1, 1)).value().types, std::vector<std::string>{""});
  EXPECT_EQ(read_output_setup(1, text("A,,B,")).value().types, (std::vector<std::string>{"A", "", "B", ""}));
}

TEST(RtdePackages, TextsAreCutAndMadePrintable) {
  EXPECT_EQ(read_text(1, number(0, 1) + text("a\nb\x80")), "a b ");
  EXPECT_EQ(read_text(2, number(200, 1) + text(std::string(200, 'x')) + number(0, 2)).size(), 120U);
  EXPECT_EQ(read_text(2, number(9, 1) + text("short")), "") << "the length lies";
  EXPECT_EQ(read_text(2, {}), "");
}

}  // namespace
}  // namespace calibrd::rtde
