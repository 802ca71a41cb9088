// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/robot/triangle_mesh.hpp"

namespace calibrd {

/// The shapes of URDF, centred on the origin, normals outward, closed. Round shapes lie half inside and half
/// outside the true surface (vertices out by as much as facet middles are in), so that a fit to them has no
/// bias; the error stays under 0.1 mm up to a radius of 1 m.

/// Edge lengths in m.
TriangleMesh make_box(const Eigen::Vector3d& size_m);

/// Axis along z, from -length/2 to length/2.
TriangleMesh make_cylinder(double radius_m, double length_m);

TriangleMesh make_sphere(double radius_m);

}  // namespace calibrd
