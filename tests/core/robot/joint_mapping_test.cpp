// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/joint_mapping.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace calibrd {
namespace {

const std::vector<std::string> kArm{"joint_s", "joint_l", "joint_e", "joint_u",
                                    "joint_r", "joint_b", "joint_t"};
const std::vector<std::string> kThree{"joint_1", "joint_2", "joint_3"};
const std::vector<double> kWire{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0, 0, 0};  // MotoROS always sends ten

JointMapping make(const JointMappingConfig& config, const std::vector<std::string>& model_joints) {
  auto mapping = JointMapping::make(config, model_joints);
  if (!mapping) throw std::runtime_error(mapping.error().message());
  return std::move(*mapping);
}

void expect_error(const JointMappingConfig& config, JointMappingError code, const std::string& culprit) {
  const auto mapping = JointMapping::make(config, kThree);
  ASSERT_FALSE(mapping) << culprit;
  EXPECT_EQ(mapping.error().code, code) << mapping.error().message();
  EXPECT_NE(mapping.error().message().find(culprit), std::string::npos) << mapping.error().message();
}

TEST(JointMapping, YaskawaWireIsTheModelsOwnOrder) {
  const auto config = yaskawa_7axis_wire(kArm);
  ASSERT_TRUE(config);
  const auto mapping = make(*config, kArm);
  EXPECT_EQ(mapping.positions(kWire).value(), (std::vector<double>{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7}));
  EXPECT_FALSE(find_pendant_order(mapping));
}

TEST(JointMapping, YaskawaPresetWantsSevenJoints) {
  const auto config = yaskawa_7axis_wire(kThree);
  ASSERT_FALSE(config);
  EXPECT_EQ(config.error().code, JointMappingError::wrong_joint_count);
}

TEST(JointMapping, PendantOrderIsFoundOut) {
  const std::vector<std::string> pendant{"joint_s", "joint_l", "joint_u", "joint_r",
                                         "joint_b", "joint_t", "joint_e"};
  const auto found = find_pendant_order(make(joints_in_wire_order(pendant), kArm));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->code, JointMappingError::pendant_order);
}

TEST(JointMapping, SignScaleOffsetAndOrderAreAppliedPerJoint) {
  JointMappingConfig config;
  config.joints = {{.joint = "joint_3", .axis = 0, .sign = -1, .offset_rad = 1, .coupling = {}},
                   {.joint = "joint_1", .axis = 1, .scale = 0.001, .coupling = {}},
                   {.joint = "joint_2", .axis = 5, .coupling = {}}};
  const auto mapping = make(config, kThree);
  const auto positions = mapping.positions(kWire).value();
  EXPECT_DOUBLE_EQ(positions[0], 0.0002);
  EXPECT_DOUBLE_EQ(positions[1], 0.6);
  EXPECT_DOUBLE_EQ(positions[2], 0.9);
  EXPECT_EQ(mapping.axes(), (std::vector{1, 5, 0}));
}

TEST(JointMapping, CoupledAxisIsAddedBeforeTheSign) {
  auto config = joints_in_wire_order(kThree);
  config.joints[2].sign = -1;
  config.joints[2].coupling = {{1, 1.0}};  // FANUC: J3 is stated against the horizontal
  EXPECT_DOUBLE_EQ(make(config, kThree).positions(kWire).value()[2], -(0.3 + 0.2));
}

TEST(JointMapping, VelocitiesLeaveOffsetsOut) {
  auto config = joints_in_wire_order(kThree);
  config.joints[0].offset_rad = 0.5;
  config.joints[1].sign = -1;
  EXPECT_EQ(make(config, kThree).velocities(kWire).value(), (std::vector{0.1, -0.2, 0.3}));
}

TEST(JointMapping, AxesMayBeNamed) {
  JointMappingConfig config = joints_in_wire_order(kThree);
  config.axis_names = {"S", "L", "E"};
  config.joints[0].axis = "E";
  config.joints[2].axis = "S";
  EXPECT_EQ(make(config, kThree).axes(), (std::vector{2, 1, 0}));
  config.joints[2].axis = "B";
  expect_error(config, JointMappingError::unknown_axis, "axis 'B', known: S, L, E");
}

TEST(JointMapping, TooFewControllerValuesAreRefused) {
  const auto positions = make(joints_in_wire_order(kThree), kThree).positions(std::vector{0.1, 0.2});
  ASSERT_FALSE(positions);
  EXPECT_EQ(positions.error().code, JointMappingError::too_few_values);
}

TEST(JointMapping, MissingJointIsNamed) {
  auto config = joints_in_wire_order(kThree);
  config.joints.pop_back();
  expect_error(config, JointMappingError::missing_joint, "'joint_3'");
}

TEST(JointMapping, UnknownJointNamesTheNearest) {
  auto config = joints_in_wire_order(kThree);
  config.joints[1].joint = "jiont_2";
  expect_error(config, JointMappingError::unknown_joint, "did you mean 'joint_2'?");
}

TEST(JointMapping, JointMappedTwiceIsNamed) {
  auto config = joints_in_wire_order(kThree);
  config.joints.push_back({.joint = "joint_1", .axis = 7, .coupling = {}});
  expect_error(config, JointMappingError::joint_twice, "'joint_1'");
}

TEST(JointMapping, AxisUsedTwiceNamesBothJoints) {
  auto config = joints_in_wire_order(kThree);
  config.joints[2].axis = 0;
  expect_error(config, JointMappingError::axis_twice, "'joint_1' and 'joint_3', axis 0");
}

TEST(JointMapping, AxisOutOfRangeIsRefused) {
  for (const int axis : {-1, 10}) {
    auto config = joints_in_wire_order(kThree);
    config.joints[0].axis = axis;
    expect_error(config, JointMappingError::axis_out_of_range, "axis " + std::to_string(axis) + " of 10");
  }
  auto config = joints_in_wire_order(kThree);
  config.joints[0].coupling = {{12, 1.0}};
  expect_error(config, JointMappingError::axis_out_of_range, "axis 12 of 10");
}

TEST(JointMapping, NumbersThatMakeNoSenseAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refuse = [](auto change) {
    auto config = joints_in_wire_order(kThree);
    change(config.joints[1]);
    expect_error(config, JointMappingError::bad_number, "'joint_2'");
  };
  refuse([](auto& entry) { entry.sign = 0.5; });
  refuse([](auto& entry) { entry.scale = 0; });
  refuse([=](auto& entry) { entry.scale = nan; });
  refuse([=](auto& entry) { entry.offset_rad = nan; });
  refuse([=](auto& entry) { entry.coupling = {{0, nan}}; });
}

TEST(JointMapping, TheWayBackGivesWhatTheControllerSends) {
  const std::vector<std::string> joints{"a", "b"};
  JointMappingConfig config;
  config.joints = {{.joint = "a", .axis = 2, .sign = -1, .offset_rad = 0.5, .coupling = {}},
                   {.joint = "b", .axis = 0, .coupling = {}}};
  const auto mapping = JointMapping::make(config, joints);
  ASSERT_TRUE(mapping) << mapping.error().message();
  const std::vector<double> controller{0.1, 7, 0.3, 8};
  const auto model = *mapping->positions(controller);
  const auto back = mapping->controller_values(model, {0, 7, 0, 8});
  ASSERT_TRUE(back) << back.error().message();
  for (std::size_t i = 0; i < controller.size(); ++i) EXPECT_DOUBLE_EQ((*back)[i], controller[i]);
}

TEST(JointMapping, ThereIsNoWayBackOverScaledOrCoupledAxes) {
  const std::vector<std::string> joints{"a", "b"};
  JointMappingConfig scaled;
  scaled.joints = {{.joint = "a", .axis = 0, .scale = 2, .coupling = {}},
                   {.joint = "b", .axis = 1, .coupling = {}}};
  auto coupled = scaled;
  coupled.joints[0].scale = 1;
  coupled.joints[1].coupling = {{0, 1.0}};
  for (const auto& config : {scaled, coupled}) {
    const auto back = JointMapping::make(config, joints)->controller_values(std::vector{0.1, 0.2}, {0, 0});
    ASSERT_FALSE(back);
    EXPECT_EQ(back.error().code, JointMappingError::not_invertible);
  }
}

}  // namespace
}  // namespace calibrd
