// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/background_align.hpp"

#include <gtest/gtest.h>

#include "core/drift/background_match.hpp"
#include "tests/core/drift/room.hpp"

namespace calibrd {
namespace {

using namespace test;

constexpr double kDegree = 0.0174532925199433;

std::optional<BackgroundAlignment> aligned(Room& room, const BackgroundMap& map, const Pose& T_base_sensor) {
  BackgroundMatcher matcher(map);
  const auto joints = postures(2)[1];
  const View view = room.seen_from(T_base_sensor, joints);
  matcher.match(view.depth, mask_of(room, joints), true_T_base_sensor().linear());
  return align_background(map, matcher.depth_m(), mask_of(room, joints), Pose::Identity());
}

void expect_found(double shift_m, double turn_deg) {
  Room room = Room::furnished();
  const BackgroundMap map = learnt(room);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    Vector6d knock;
    for (double& value : knock) value = normal(random);
    knock.head<3>() *= turn_deg * kDegree / knock.head<3>().norm();
    knock.tail<3>() *= shift_m / knock.tail<3>().norm();
    const Pose now = perturbed(true_T_base_sensor(), knock);
    const auto found = aligned(room, map, now);
    ASSERT_TRUE(found) << seed;
    const Vector6d error = difference(true_T_base_sensor().inverse() * now, found->T_learnt_now);
    EXPECT_LT(error.tail<3>().norm(), 0.008) << seed;
    EXPECT_LT(error.head<3>().norm(), 0.006) << seed;
    EXPECT_GT(found->inliers, 0.6) << seed;
    EXPECT_GT(found->inliers * found->on_planes, 1.5 * found->in_place) << seed;
  }
}

TEST(AlignBackground, FindsAKnockOf30mmAnd3Degrees) { expect_found(0.03, 3); }
TEST(AlignBackground, FindsAKnockOf60mmAnd5Degrees) { expect_found(0.06, 5); }

TEST(AlignBackground, SaysHowMuchOfWhatASensorThatStandsSeesIsInPlace) {
  Room room = Room::furnished();
  const BackgroundMap map = learnt(room);
  room.hidden_share = 0.3;
  const auto found = aligned(room, map, true_T_base_sensor());
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->in_place, 0.5, 0.1);
  EXPECT_LT(found->inliers * found->on_planes, 1.1 * found->in_place);
}

TEST(AlignBackground, FindsNothingWhereNothingIsKnown) {
  Room room = Room::furnished();
  const BackgroundMap map = learnt(room);
  const Vector6d turned_away = (Vector6d() << 0, 0, 2.5, 0, 0, 0).finished();
  Room other = Room::furnished();
  other.blocks.resize(1);
  EXPECT_FALSE(aligned(other, map, perturbed(true_T_base_sensor(), turned_away)));
}

}  // namespace
}  // namespace calibrd
