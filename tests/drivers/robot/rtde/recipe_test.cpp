// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/robot/rtde/recipe.hpp"

#include <gtest/gtest.h>

#include "drivers/robot/rtde/error.hpp"
#include "tests/drivers/robot/rtde/rtde_bytes.hpp"

namespace calibrd::rtde {
namespace {

using namespace rtde_bytes;

TEST(RtdeRecipe, ReadsTheDataOfTheMakersLibrary) {
  const Bytes package =
      hex("003c55003fe6d19a9d2d55813fb999999999999abfc999999999999a3fd3333333333333bfd999999999999a3fe0000000"
          "000000bfe33333"
          "33333333");
  const auto state =
      read_state(std::array{Variable::timestamp, Variable::actual_q}, std::span(package).subspan(4));
  ASSERT_TRUE(state) << state.error().message();
  EXPECT_NEAR(state->timestamp_s, 0.7131, 1e-4);
  EXPECT_EQ(state->positions_rad, (Joints{0.1, -0.2, 0.3, -0.4, 0.5, -0.6}));
}

TEST(RtdeRecipe, ReadsAllThatIsAskedFor) {
  const Data sent{12.5, {1, 2, 3, 4, 5, 6}, {-1, -2, -3, -4, -5, -6}, -1, 0x80000001};
  const auto state = read_state(kAllVariables, fields(sent));
  ASSERT_TRUE(state);
  EXPECT_EQ(state->timestamp_s, 12.5);
  EXPECT_EQ(state->positions_rad, sent.positions);
  EXPECT_EQ(state->velocities_rad_s, sent.velocities);
  EXPECT_EQ(state->mode, -1);
  EXPECT_TRUE(state->is(SafetyBit::normal));
  EXPECT_FALSE(state->is(SafetyBit::fault));
}

TEST(RtdeRecipe, DataOfAnotherSizeIsRefused) {
  const Bytes whole = fields({});
  for (const std::size_t size : {std::size_t{0}, whole.size() - 1, whole.size() + 1}) {
    Bytes bytes = whole;
    bytes.resize(size);
    EXPECT_EQ(read_state(kAllVariables, bytes).error().code, RtdeError::wrong_payload_size) << size;
  }
}

TEST(RtdeRecipe, NamesEveryVariableThatIsNotFound) {
  const auto checked = check_types(kAllVariables, {"DOUBLE", "VECTOR6D", "NOT_FOUND", "INT32", "NOT_FOUND"});
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, RtdeError::variable_not_found);
  EXPECT_EQ(checked.error().detail, "actual_qd, safety_status_bits");
}

TEST(RtdeRecipe, RefusesOtherTypesAndOtherNumbersOfThem) {
  EXPECT_TRUE(check_types(kAllVariables, {"DOUBLE", "VECTOR6D", "VECTOR6D", "INT32", "UINT32"}));
  const auto other = check_types(kAllVariables, {"DOUBLE", "VECTOR6D", "VECTOR3D", "INT32", "UINT32"});
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, RtdeError::variable_of_other_type);
  EXPECT_EQ(other.error().detail, "actual_qd is VECTOR3D, not VECTOR6D");
  EXPECT_EQ(check_types(kAllVariables, {"DOUBLE"}).error().code, RtdeError::unexpected_package);
  EXPECT_EQ(check_types(kAllVariables, std::vector<std::string>(6, "DOUBLE")).error().code,
            RtdeError::unexpected_package);
}

TEST(RtdeError, SaysWhatToDoForEveryCode) {
  for (int code = 1; code <= static_cast<int>(RtdeError::value_out_of_range); ++code)
    EXPECT_NE(make_error_code(static_cast<RtdeError>(code)).message(), "unknown RTDE error") << code;
}

}  // namespace
}  // namespace calibrd::rtde
