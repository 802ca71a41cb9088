// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/link_surface.hpp"

#include <urdf_model/link.h>

#include <algorithm>

#include "core/robot/mesh_file.hpp"
#include "core/robot/mesh_path.hpp"
#include "core/robot/primitives.hpp"
#include "core/robot/robot_model_error.hpp"
#include "core/robot/urdf_pose.hpp"

namespace calibrd {
namespace {

bool are_sizes(const Eigen::Vector3d& sizes) { return are_usable(sizes) && (sizes.array() > 0).all(); }

Error bad_geometry(const char* what) { return {RobotModelError::bad_geometry, what}; }

Result<TriangleMesh> read_mesh(const urdf::Mesh& mesh, const std::filesystem::path& urdf,
                               const RobotModelOptions& options) {
  const Eigen::Vector3d scale = to_eigen(mesh.scale);
  if (!are_usable(scale) || (scale.array() == 0).any()) return bad_geometry("<mesh scale>");
  const auto file = find_mesh(mesh.filename, urdf, options.search_paths);
  if (!file) return file.error();
  const auto unscaled = read_mesh_file(*file);
  if (!unscaled) return unscaled.error();
  TriangleMesh scaled;
  append(scaled, *unscaled, Eigen::Affine3d(Eigen::Scaling(scale)));
  if (!std::ranges::all_of(scaled.vertices, [](const auto& vertex) { return are_usable(vertex); }))
    return bad_geometry("<mesh> larger than a million metres");
  return scaled;
}

Result<TriangleMesh> shape_of(const urdf::Geometry& geometry, const std::filesystem::path& urdf,
                              const RobotModelOptions& options) {
  switch (geometry.type) {
    case urdf::Geometry::SPHERE: {
      const double radius_m = static_cast<const urdf::Sphere&>(geometry).radius;
      return are_sizes({radius_m, 1, 1}) ? Result(make_sphere(radius_m)) : bad_geometry("<sphere>");
    }
    case urdf::Geometry::BOX: {
      const Eigen::Vector3d size_m = to_eigen(static_cast<const urdf::Box&>(geometry).dim);
      return are_sizes(size_m) ? Result(make_box(size_m)) : bad_geometry("<box>");
    }
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
      if (!are_sizes({cylinder.radius, cylinder.length, 1})) return bad_geometry("<cylinder>");
      return make_cylinder(cylinder.radius, cylinder.length);
    }
    case urdf::Geometry::MESH:
      return read_mesh(static_cast<const urdf::Mesh&>(geometry), urdf, options);
  }
  return bad_geometry("<geometry>");
}

/// Shapes: the link's <visual>s or <collision>s, which urdfdom keeps as two types with the same members.
template <class Shapes>
Result<TriangleMesh> join(const Shapes& shapes, const urdf::Link& link, const std::filesystem::path& urdf,
                          const RobotModelOptions& options) {
  TriangleMesh surface;
  for (const auto& shape : shapes) {
    const auto in_link = [&](const Error& error) {
      return Error{error.code, "link '" + link.name + "': " + error.detail};
    };
    if (!shape || !shape->geometry) return in_link(bad_geometry("no <geometry>"));
    const Pose T_link_shape = to_pose(shape->origin);
    if (!are_usable(T_link_shape.matrix())) return in_link({RobotModelError::bad_number, "<origin>"});
    const auto mesh = shape_of(*shape->geometry, urdf, options);
    if (!mesh) return in_link(mesh.error());
    append(surface, *mesh, Eigen::Affine3d(T_link_shape));
  }
  return surface;
}

}  // namespace

Result<TriangleMesh> read_link_surface(const urdf::Link& link, const std::filesystem::path& urdf,
                                       const RobotModelOptions& options) {
  if (!link.visual_array.empty()) return join(link.visual_array, link, urdf, options);
  return join(link.collision_array, link, urdf, options);
}

}  // namespace calibrd
