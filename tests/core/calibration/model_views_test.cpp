// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/model_views.hpp"

#include <gtest/gtest.h>

#include "core/capture/capture_error.hpp"
#include "tests/core/virtual_cell/urdf_text.hpp"

namespace calibrd {
namespace {

using namespace test;

/// Joints a, b and c in a row, then a fixed one and one that follows c.
const RobotModel& chain() {
  static const RobotModel robot = robot_from(
      link("l0") + link("l1") + link("l2") + link("l3") + link("l4") + link("l5") +
      revolute("a", "l0", "l1", "0 0 1", Pose::Identity()) +
      revolute("b", "l1", "l2", "0 0 1", Pose::Identity()) +
      revolute("c", "l2", "l3", "0 0 1", Pose::Identity()) +
      "<joint name='bolt' type='fixed'><parent link='l3'/><child link='l4'/></joint>"
      "<joint name='shadow' type='continuous'><parent link='l4'/><child link='l5'/><axis xyz='0 0 1'/>"
      "<mimic joint='c'/></joint>");
  return robot;
}

Capture recorded(std::vector<std::string> joint_names) {
  Capture capture;
  capture.joint_names = std::move(joint_names);
  for (const double first : {10.0, 20.0}) {
    View view;
    for (std::size_t i = 0; i < capture.joint_names.size(); ++i)
      view.joint_positions_rad.push_back(first + static_cast<double>(i));
    view.stamp_s = first;
    capture.views.push_back(std::move(view));
  }
  return capture;
}

void expect_code(const Result<std::vector<View>>& views, CaptureError code, const std::string& named) {
  ASSERT_FALSE(views);
  EXPECT_EQ(views.error().code, make_error_code(code)) << views.error().message();
  EXPECT_NE(views.error().detail.find(named), std::string::npos) << views.error().message();
}

TEST(ModelViews, JointsAreBroughtIntoTheModelsOrder) {
  const auto views = views_in_model_order(chain(), recorded({"c", "a", "b"}));
  ASSERT_TRUE(views) << views.error().message();
  ASSERT_EQ(views->size(), 2U);
  EXPECT_EQ((*views)[0].joint_positions_rad, (std::vector{11.0, 12.0, 10.0}));
  EXPECT_EQ((*views)[1].joint_positions_rad, (std::vector{21.0, 22.0, 20.0}));
  EXPECT_EQ((*views)[1].stamp_s, 20.0);
}

TEST(ModelViews, SameOrderStaysAsItIs) {
  const auto views = views_in_model_order(chain(), recorded({"a", "b", "c"}));
  ASSERT_TRUE(views);
  EXPECT_EQ((*views)[0].joint_positions_rad, (std::vector{10.0, 11.0, 12.0}));
}

TEST(ModelViews, UnknownJointIsNamed) {
  expect_code(views_in_model_order(chain(), recorded({"a", "b", "d"})), CaptureError::unknown_joint, "\"d\"");
}

TEST(ModelViews, JointNamesAreCaseSensitive) {
  expect_code(views_in_model_order(chain(), recorded({"a", "b", "C"})), CaptureError::unknown_joint, "\"C\"");
}

TEST(ModelViews, MissingJointIsNamed) {
  expect_code(views_in_model_order(chain(), recorded({"a", "c"})), CaptureError::missing_joint, "\"b\"");
}

TEST(ModelViews, DuplicateJointIsNamed) {
  expect_code(views_in_model_order(chain(), recorded({"a", "b", "b"})), CaptureError::duplicate_joint,
              "\"b\"");
}

TEST(ModelViews, JointThatFollowsAnotherIsNotRecorded) {
  expect_code(views_in_model_order(chain(), recorded({"a", "b", "c", "shadow"})), CaptureError::unknown_joint,
              "\"shadow\"");
}

TEST(ModelViews, RobotWithoutJointsNeedsNone) {
  const auto views = views_in_model_order(robot_from(link("base")), recorded({}));
  ASSERT_TRUE(views) << views.error().message();
  EXPECT_TRUE((*views)[0].joint_positions_rad.empty());
}

}  // namespace
}  // namespace calibrd
