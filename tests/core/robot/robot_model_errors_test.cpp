// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "core/robot/robot_model.hpp"
#include "core/robot/robot_model_error.hpp"
#include "tests/core/robot/scratch_folder.hpp"

// urdfdom never frees links that form a ring. Read by the leak sanitizer when there is one.
extern "C" const char* __lsan_default_suppressions() { return "leak:liburdfdom_model"; }

namespace calibrd {
namespace {

const std::string kLimit = R"(<limit lower="-1" upper="1" effort="0" velocity="1"/>)";

/// A joint from `parent` to `child`; `inside`: what else stands in it.
std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& inside = {}) {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + inside + kLimit + "</joint>";
}

std::string links(std::initializer_list<const char*> names) {
  std::string text;
  for (const auto* name : names) text += "<link name=\"" + std::string(name) + "\"/>";
  return text;
}

std::string robot(const std::string& body) { return "<robot name=\"r\">" + body + "</robot>"; }

std::string shape(const std::string& geometry) {
  return robot("<link name=\"housing\"><visual><geometry>" + geometry + "</geometry></visual></link>");
}

std::string repeated(const std::string& part, std::size_t times) {
  std::string text;
  for (std::size_t i = 0; i < times; ++i) text += part;
  return text;
}

struct BadRobot {
  const char* name;
  std::string urdf;
  RobotModelError code;
  const char* culprit;  ///< named by the message
};

void PrintTo(const BadRobot& bad, std::ostream* out) { *out << bad.name; }

class BadRobots : public ::testing::TestWithParam<BadRobot> {};

TEST_P(BadRobots, AreRefusedAndTheCulpritIsNamed) {
  const auto& [name, urdf, code, culprit] = GetParam();
  const test::ScratchFolder folder;
  folder.write("broken.stl", "no mesh");
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  const auto robot = RobotModel::load(folder.write("r.urdf", urdf));
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");  // core prints nothing
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  ASSERT_FALSE(robot);
  EXPECT_EQ(robot.error().code, code) << robot.error().message();
  EXPECT_NE(robot.error().message().find(culprit), std::string::npos) << robot.error().message();
}

const BadRobot kBadRobots[] = {
    {"empty_file", " \n", RobotModelError::urdf_invalid, "r.urdf (the file is empty)"},
    {"broken_xml", "<robot name='r'><link name='a'>", RobotModelError::urdf_invalid, "r.urdf"},
    {"not_a_robot", "<sdf/>", RobotModelError::urdf_invalid, "r.urdf"},
    {"no_links", robot(""), RobotModelError::urdf_invalid, "r.urdf"},
    {"two_roots", robot(links({"a", "b"})), RobotModelError::urdf_invalid, "[b]"},
    {"unknown_child", robot(links({"a"}) + joint("j", "revolute", "a", "ghost")),
     RobotModelError::urdf_invalid, "ghost"},
    {"same_link_twice", robot(links({"a", "a"})), RobotModelError::urdf_invalid, "a"},
    {"ring", robot(links({"a", "b"}) + joint("j", "revolute", "a", "b") + joint("k", "revolute", "b", "a")),
     RobotModelError::urdf_invalid, "root"},
    {"ring_beside_the_tree",
     robot(links({"a", "b", "c"}) + joint("j", "revolute", "b", "c") + joint("k", "revolute", "c", "b")),
     RobotModelError::not_a_tree, "'b'"},
    {"two_parents",
     robot(links({"a", "b", "c"}) + joint("j", "revolute", "a", "b") + joint("k", "revolute", "a", "c") +
           joint("m", "revolute", "b", "c")),
     RobotModelError::not_a_tree, "'c'"},
    {"revolute_without_limit",
     robot(links({"a", "b"}) +
           R"(<joint name="j" type="revolute"><parent link="a"/><child link="b"/></joint>)"),
     RobotModelError::urdf_invalid, "j"},
    {"floating", robot(links({"a", "b"}) + joint("buoy", "floating", "a", "b")),
     RobotModelError::unsupported_joint, "'buoy' is floating"},
    {"planar", robot(links({"a", "b"}) + joint("sled", "planar", "a", "b")),
     RobotModelError::unsupported_joint, "'sled' is planar"},
    {"zero_axis", robot(links({"a", "b"}) + joint("j", "revolute", "a", "b", "<axis xyz='0 0 0'/>")),
     RobotModelError::bad_axis, "'j'"},
    {"nan_axis", robot(links({"a", "b"}) + joint("j", "revolute", "a", "b", "<axis xyz='nan 0 0'/>")),
     RobotModelError::urdf_invalid, "nan"},
    {"nan_origin", robot(links({"a", "b"}) + joint("j", "revolute", "a", "b", "<origin xyz='0 nan 0'/>")),
     RobotModelError::urdf_invalid, "joint [j]"},
    {"mimics_itself", robot(links({"a", "b"}) + joint("j", "revolute", "a", "b", "<mimic joint='j'/>")),
     RobotModelError::bad_mimic, "'j'"},
    {"mimic_cycle",
     robot(links({"a", "b", "c"}) + joint("j", "revolute", "a", "b", "<mimic joint='k'/>") +
           joint("k", "revolute", "b", "c", "<mimic joint='j'/>")),
     RobotModelError::bad_mimic, "'j' mimics joints that in the end mimic each other"},
    {"mimics_unknown",
     robot(links({"a", "b", "c"}) + joint("finger_left", "revolute", "a", "b") +
           joint("k", "revolute", "b", "c", "<mimic joint='finger_lefd'/>")),
     RobotModelError::bad_mimic, "did you mean 'finger_left'?"},
    {"mimics_fixed",
     robot(links({"a", "b", "c"}) + joint("weld", "fixed", "a", "b") +
           joint("k", "revolute", "b", "c", "<mimic joint='weld'/>")),
     RobotModelError::bad_mimic, "'weld'"},
    {"missing_mesh", shape("<mesh filename='package://arm/gone.stl'/>"), RobotModelError::mesh_not_found,
     "link 'housing': 'package://arm/gone.stl'"},
    {"broken_mesh", shape("<mesh filename='broken.stl'/>"), RobotModelError::mesh_unreadable, "broken.stl"},
    {"flat_scale", shape("<mesh filename='broken.stl' scale='1 0 1'/>"), RobotModelError::bad_geometry,
     "<mesh scale>"},
    {"negative_box", shape("<box size='1 -1 1'/>"), RobotModelError::bad_geometry, "link 'housing': <box>"},
    {"flat_cylinder", shape("<cylinder radius='1' length='0'/>"), RobotModelError::bad_geometry,
     "<cylinder>"},
    {"huge_cylinder", shape("<cylinder radius='1e300' length='1'/>"), RobotModelError::bad_geometry,
     "<cylinder>"},
    {"huge_origin", robot(links({"a", "b"}) + joint("j", "revolute", "a", "b", "<origin xyz='1e300 0 0'/>")),
     RobotModelError::bad_number, "'j' <origin>"},
    {"huge_mimic",
     robot(links({"a", "b", "c"}) + joint("j", "revolute", "a", "b") +
           joint("k", "revolute", "b", "c", "<mimic joint='j' multiplier='1e300'/>")),
     RobotModelError::bad_number, "'k' <mimic>"},
    {"nested_without_end", robot(repeated("<a>", 100'000)), RobotModelError::urdf_invalid, "64 deep"},
    {"nested_beside_a_comment", robot(repeated("<a b='<!--'>", 100'000)), RobotModelError::urdf_invalid,
     "64 deep"},
    {"a_thousand_links", robot(repeated("<link name='a'/>", 1001)), RobotModelError::urdf_invalid,
     "1000 links"},
    {"point_sphere", shape("<sphere radius='0'/>"), RobotModelError::bad_geometry, "<sphere>"},
};

INSTANTIATE_TEST_SUITE_P(RobotModel, BadRobots, ::testing::ValuesIn(kBadRobots),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(RobotModel, MissingUrdfIsNamed) {
  const auto robot = RobotModel::load("/nowhere/robot.urdf");
  ASSERT_FALSE(robot);
  EXPECT_EQ(robot.error().code, RobotModelError::urdf_not_found);
  EXPECT_NE(robot.error().detail.find("/nowhere/robot.urdf"), std::string::npos);
}

TEST(RobotModel, FolderInsteadOfUrdfIsRefused) {
  const test::ScratchFolder folder;
  const auto robot = RobotModel::load(folder.path());
  ASSERT_FALSE(robot);
  EXPECT_EQ(robot.error().code, RobotModelError::urdf_not_found);
}

TEST(RobotModel, UnknownBaseLinkNamesTheNearest) {
  const test::ScratchFolder folder;
  const auto urdf = folder.write("r.urdf", robot(links({"base_link"})));
  const auto model = RobotModel::load(urdf, {.search_paths = {}, .base_link = "base_lnk"});
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().code, RobotModelError::unknown_link);
  EXPECT_NE(model.error().message().find("did you mean 'base_link'?"), std::string::npos)
      << model.error().message();
}

TEST(RobotModel, CollisionShapesStandInForMissingVisualOnes) {
  const test::ScratchFolder folder;
  const std::string collision = "<collision><geometry><box size='1 1 1'/></geometry></collision>";
  const std::string visual = "<visual><geometry><box size='2 2 2'/></geometry></visual>";
  const auto area = [&](const std::string& shapes) {
    const auto model =
        RobotModel::load(folder.write("r.urdf", robot("<link name='l'>" + shapes + "</link>")));
    return model ? surface_area(model->links()[0].surface) : -1;
  };
  EXPECT_NEAR(area(collision), 6, 1e-6);
  EXPECT_NEAR(area(collision + visual), 24, 1e-6);
  EXPECT_NEAR(area(visual + "<visual><origin xyz='0 0 9'/><geometry><box size='1 1 1'/></geometry></visual>"),
              30, 1e-6);
  EXPECT_EQ(area(""), 0);
}

TEST(RobotModel, JointLimitsAreKept) {
  const test::ScratchFolder folder;
  const auto model = RobotModel::load(folder.write(
      "r.urdf",
      robot(links({"a", "b", "c"}) + joint("j", "revolute", "a", "b") + joint("k", "continuous", "b", "c"))));
  ASSERT_TRUE(model) << model.error().message();
  EXPECT_EQ(model->joints()[0].limits.value().upper, 1);
  EXPECT_FALSE(model->joints()[1].limits.has_value());
}

}  // namespace
}  // namespace calibrd
