// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/mesh_file.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "core/robot/robot_model.hpp"
#include "core/robot/robot_model_error.hpp"
#include "tests/core/robot/mesh_checks.hpp"
#include "tests/core/robot/scratch_folder.hpp"

namespace calibrd {
namespace {

using test::ScratchFolder;

constexpr auto kAsciiStl = R"(solid corner
facet normal 0 0 -1 outer loop vertex 0 0 0 vertex 0 2 0 vertex 1 0 0 endloop endfacet
facet normal 0 -1 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 0 3 endloop endfacet
facet normal -1 0 0 outer loop vertex 0 0 0 vertex 0 0 3 vertex 0 2 0 endloop endfacet
facet normal 1 1 1 outer loop vertex 1 0 0 vertex 0 2 0 vertex 0 0 3 endloop endfacet
endsolid corner
)";

constexpr auto kObj = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// The tetrahedron with legs 1, 2, 3 along x, y, z.
std::string collada(const std::string& unit, const std::string& up_axis, const std::string& node_transform) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>)" +
         unit + "<up_axis>" + up_axis + R"(</up_axis></asset>
<library_geometries><geometry id="g" name="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 2 0 0 0 3</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input offset="0" semantic="VERTEX" source="#v"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s" name="s"><node id="n" name="n">)" +
         node_transform + R"(
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

std::string binary_stl(const std::vector<std::array<float, 9>>& triangles) {
  std::string bytes = "solid in name only";  // as some exporters write it
  bytes.resize(80, ' ');
  const auto put = [&](std::uint32_t value, int count) {
    for (int byte = 0; byte < count; ++byte) bytes.push_back(static_cast<char>((value >> (8 * byte)) & 0xFF));
  };
  put(static_cast<std::uint32_t>(triangles.size()), 4);
  for (const auto& triangle : triangles) {
    for (int zero = 0; zero < 3; ++zero) put(0, 4);
    for (const float value : triangle) put(std::bit_cast<std::uint32_t>(value), 4);
    put(0, 2);
  }
  return bytes;
}

TriangleMesh read(const std::string& name, const std::string& text) {
  const ScratchFolder folder;
  auto mesh = read_mesh_file(folder.write(name, text));
  if (!mesh) throw std::runtime_error(mesh.error().message());
  return std::move(*mesh);
}

void expect_tetrahedron(const TriangleMesh& mesh, const Eigen::Vector3f& legs) {
  EXPECT_EQ(mesh.vertices.size(), 4U);
  EXPECT_TRUE(test::is_closed(mesh));
  EXPECT_TRUE(test::bounds(mesh).max().isApprox(legs, 1e-5F)) << test::bounds(mesh).max().transpose();
  EXPECT_NEAR(test::volume(mesh) / (legs.x() * legs.y() * legs.z() / 6), 1, 1e-5);  // positive: outward
}

void expect_unreadable(const std::string& name, const std::string& text) {
  const ScratchFolder folder;
  const auto file = folder.write(name, text);
  const auto mesh = read_mesh_file(file);
  ASSERT_FALSE(mesh) << name;
  EXPECT_EQ(mesh.error().code, RobotModelError::mesh_unreadable);
  EXPECT_NE(mesh.error().detail.find(file.string()), std::string::npos) << mesh.error().message();
}

TEST(MeshFile, AsciiStlIsInMetres) { expect_tetrahedron(read("a.stl", kAsciiStl), {1, 2, 3}); }

TEST(MeshFile, BinaryStlIsReadThoughItsHeaderSaysSolid) {
  const auto mesh = read("b.stl", binary_stl({{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 0, 0, 0, 1, 0, 0, 0, 1}}));
  EXPECT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.vertices.size(), 4U);  // shared ones stored once
}

TEST(MeshFile, ObjIsInMetres) { expect_tetrahedron(read("a.obj", kObj), {1, 2, 3}); }

TEST(MeshFile, ColladaWithoutUnitIsInMetres) {
  expect_tetrahedron(read("a.dae", collada("", "Z_UP", "")), {1, 2, 3});
}

TEST(MeshFile, ColladaUnitIsAppliedOnce) {
  const auto text = collada(R"(<unit name="millimeter" meter="0.001"/>)", "Z_UP", "");
  expect_tetrahedron(read("mm.dae", text), {0.001F, 0.002F, 0.003F});
}

TEST(MeshFile, ColladaUnitAlsoScalesTheNodesOfItsScene) {
  const auto text = collada(R"(<unit name="inch" meter="0.0254"/>)", "Z_UP",
                            "<matrix>0 -2 0 10 2 0 0 20 0 0 2 30 0 0 0 1</matrix>");
  const auto mesh = read("in.dae", text);
  const auto box = test::bounds(mesh);
  EXPECT_TRUE(box.min().isApprox(0.0254F * Eigen::Vector3f(6, 20, 30), 1e-5F)) << box.min().transpose();
  EXPECT_TRUE(box.max().isApprox(0.0254F * Eigen::Vector3f(10, 22, 36), 1e-5F)) << box.max().transpose();
}

TEST(MeshFile, ColladaUpAxisIsIgnored) {
  for (const auto* up_axis : {"X_UP", "Y_UP", "Z_UP"})
    expect_tetrahedron(read("a.dae", collada("", up_axis, "")), {1, 2, 3});
}

TEST(MeshFile, BrokenFilesAreNamed) {
  expect_unreadable("cut.stl", binary_stl({{0, 0, 0, 1, 0, 0, 0, 1, 0}}).substr(0, 90));
  expect_unreadable("empty.stl", "");
  expect_unreadable("words.stl", "this is no mesh");
  expect_unreadable("broken.dae", collada("", "Z_UP", "").substr(0, 400));
  expect_unreadable("no_triangle.dae", R"(<?xml version="1.0"?><COLLADA version="1.4.1"/>)");
  expect_unreadable("points.obj", "v 0 0 0\nv 1 0 0\n");
  expect_unreadable("unknown.xyzzy", "?");
}

TEST(MeshFile, OtherKindsAreRefusedWhateverTheyHold) {
  expect_unreadable("a.ply", kAsciiStl);
  expect_unreadable("a", kAsciiStl);
  expect_unreadable("off.stl", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");  // assimp reads OFF
  expect_tetrahedron(read("A.STL", kAsciiStl), {1, 2, 3});
}

TEST(MeshFile, ColladaThatWouldExhaustAssimpIsRefused) {
  const auto with_nodes = [](const std::string& nodes) {
    return collada("", "Z_UP", "</node>" + nodes + "<node id=\"last\">");
  };
  std::string deep, doubling;
  for (int i = 0; i < 20'000; ++i) deep += "<node>";
  for (int i = 0; i < 40; ++i) {
    const auto instance = "<instance_node url=\"#n" + std::to_string(i + 1) + "\"/>";
    doubling += "<node id=\"n" + std::to_string(i) + "\">" + instance + instance + "</node>";
  }
  expect_unreadable("deep.dae", with_nodes(deep));
  expect_unreadable("doubling.dae", with_nodes(doubling + "<node id=\"n40\"/>"));
  expect_unreadable("self.dae", collada("", "Z_UP", "<instance_node url=\"#n\"/>"));
  expect_unreadable("entity.dae", collada("", "Z_UP", "<instance_node url=\"#&#110;\"/>"));
  expect_unreadable("name.dae", with_nodes("<node name=\"a\"><instance_node url=\"#a\"/></node>"));
  expect_unreadable("zip.dae", collada("", "Z_UP", "") + "PK\5\6");
}

TEST(MeshFile, ColladaNodesMayInstanceOthers) {
  const auto text = collada("", "Z_UP", "<instance_node url=\"#m\"/></node><node id=\"m\">");
  EXPECT_FALSE(read("a.dae", text).triangles.empty());
}

TEST(MeshFile, VertexThatIsNotANumberIsRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  expect_unreadable("nan.stl", binary_stl({{0, 0, 0, 1, 0, 0, 0, nan, 0}}));
  expect_unreadable("inf.stl",
                    binary_stl({{0, 0, 0, 1, 0, 0, 0, std::numeric_limits<float>::infinity(), 0}}));
}

TEST(MeshScale, ScalesMetresAndMirrorsWithoutTurningNormalsInward) {
  const ScratchFolder folder;
  folder.write("meshes/a.stl", kAsciiStl);
  const auto urdf = folder.write("r.urdf", R"(<robot name="r"><link name="l"><visual><origin xyz="0 0 5"/>
    <geometry><mesh filename="meshes/a.stl" scale="0.001 -0.001 0.002"/></geometry></visual></link></robot>)");
  const auto robot = RobotModel::load(urdf);
  ASSERT_TRUE(robot) << robot.error().message();
  const TriangleMesh& surface = robot->links()[0].surface;
  EXPECT_TRUE(test::bounds(surface).min().isApprox(Eigen::Vector3f(0, -0.002F, 5), 1e-6F));
  EXPECT_TRUE(test::bounds(surface).max().isApprox(Eigen::Vector3f(0.001F, 0, 5.006F), 1e-6F));
  EXPECT_TRUE(test::is_closed(surface));
  EXPECT_GT(test::volume(surface), 0);
}

}  // namespace
}  // namespace calibrd
