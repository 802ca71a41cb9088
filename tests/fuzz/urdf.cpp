// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// A robot model. Input: the URDF; the meshes box.stl and plate.obj lie beside it.
#include <algorithm>

#include "core/robot/robot_model.hpp"
#include "tests/core/robot/scratch_folder.hpp"
#include "tests/fuzz/fuzz.hpp"

// urdfdom never frees links that form a ring.
extern "C" const char* __lsan_default_suppressions() { return "leak:liburdfdom"; }

namespace {

using namespace calibrd;

constexpr const char* kStl =
    "solid box\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    "endsolid box\n";
constexpr const char* kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

struct Folder : test::ScratchFolder {
  Folder() {
    write("box.stl", kStl);
    write("plate.obj", kObj);
  }
};

void check(const TriangleMesh& surface) {
  for (const auto& vertex : surface.vertices)
    fuzz::require(vertex.allFinite(), "a surface has finite corners");
  for (const auto& triangle : surface.triangles)
    for (const auto corner : triangle)
      fuzz::require(corner < surface.vertices.size(), "a triangle has corners");
}

void check(const RobotModel& robot) {
  for (const auto& link : robot.links()) check(link.surface);
  for (const auto& joint : robot.joints())
    if (joint.type != JointType::fixed)
      fuzz::require(std::abs(joint.axis.norm() - 1) < 1e-9, "an axis is a unit vector");
  for (const double position : {0.0, 0.5}) {
    const std::vector<double> positions(robot.position_count(), position);
    for (const auto& T_base_link : robot.forward_kinematics(positions))
      fuzz::require(T_base_link.matrix().allFinite(), "a link is somewhere");
  }
  robot.tip_links();
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder scratch;
  const auto file = scratch.write("robot.urdf", {reinterpret_cast<const char*>(data), size});
  const auto robot = RobotModel::load(file);
  if (robot)
    check(*robot);
  else
    fuzz::require(!robot.error().message().empty(), "an error says something");
  return 0;
}
