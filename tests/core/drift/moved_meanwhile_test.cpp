// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/drift/moved_meanwhile.hpp"

#include "tests/core/drift/watched_room.hpp"

namespace calibrd {
namespace {

using namespace test;
using Witness = MovedMeanwhile::Witness;

constexpr std::size_t kViews = 6;

/// The postures' views, those from the `first_moved`-th on from a sensor that was moved.
std::vector<View> views_of(const std::function<View(const std::vector<double>&, const Pose&)>& see,
                           const Vector6d& moved, std::size_t first_moved) {
  std::vector<View> views;
  for (const auto& joints : postures(kViews)) {
    const bool is_moved = views.size() >= first_moved;
    views.push_back(see(joints, is_moved ? perturbed(true_T_base_sensor(), moved) : true_T_base_sensor()));
  }
  return views;
}

/// What stands around, and too little of the robot to say anything.
std::vector<View> of_room(Room room, const Vector6d& moved, std::size_t first_moved) {
  return views_of([&](const auto& joints, const Pose& T) { return room.seen_from(T, joints); }, moved,
                  first_moved);
}

/// The robot, and nothing else.
std::vector<View> of_robot(const Vector6d& moved, std::size_t first_moved) {
  SceneSettings settings;
  return views_of(
      [&](const auto& joints, const Pose& T) {
        ++settings.seed;
        return render_view(joints, T, settings);
      },
      moved, first_moved);
}

/// The pose that fits best lies between the two.
std::optional<MovedMeanwhile> found_in(const std::vector<View>& views, const Vector6d& moved) {
  const Pose between = perturbed(true_T_base_sensor(), 0.5 * moved);
  return ViewsInOrder(VirtualCell(test_arm()), ideal_kinect2()).find_move(views, between, {});
}

TEST(ViewsInOrder, OfASensorThatStoodShowNoMove) {
  EXPECT_FALSE(found_in(of_room(Room::furnished(), Vector6d::Zero(), 3), Vector6d::Zero()));
  EXPECT_FALSE(found_in(of_robot(Vector6d::Zero(), 3), Vector6d::Zero()));
}

TEST(ViewsInOrder, TellAfterWhichOneWhatStandsAroundShifted) {
  for (const std::size_t first_moved : {1U, 3U, 5U}) {
    const Vector6d moved = shifted(0.003, 0.003, 0);
    const auto move = found_in(of_room(Room::furnished(), moved, first_moved), moved);
    ASSERT_TRUE(move) << first_moved;
    EXPECT_EQ(move->witness, Witness::background);
    EXPECT_NEAR(move->shift_m, moved.norm(), 1e-3);
  }
}

TEST(ViewsInOrder, TellAfterWhichOneTheRobotShifted) {
  const Vector6d moved = shifted(0.004, -0.003, 0);
  const auto move = found_in(of_robot(moved, 3), moved);
  ASSERT_TRUE(move);
  EXPECT_EQ(move->witness, Witness::robot);
  EXPECT_EQ(move->before, 2U);
  EXPECT_NEAR(move->shift_m, moved.norm(), 1.5e-3);
}

TEST(ViewsInOrder, ThatTurnALittleAreFoundOut) {
  const Vector6d moved = turned(0, 0.004, 0);
  EXPECT_TRUE(found_in(of_room(Room::furnished(), moved, 2), moved));
}

TEST(ViewsInOrder, ABoxThatIsPushedMeanwhileIsNoMove) {
  Room room = Room::furnished();
  auto views = of_room(room, Vector6d::Zero(), kViews);
  room.blocks.back().middle.x() += 0.01;
  const auto later = of_room(room, Vector6d::Zero(), kViews);
  for (std::size_t i = 3; i < kViews; ++i) views[i] = later[i];
  EXPECT_FALSE(found_in(views, Vector6d::Zero()));
}

TEST(ViewsInOrder, OneViewShowsNoMove) {
  auto views = of_robot(Vector6d::Zero(), 1);
  views.resize(1);
  EXPECT_FALSE(found_in(views, Vector6d::Zero()));
}

}  // namespace
}  // namespace calibrd
