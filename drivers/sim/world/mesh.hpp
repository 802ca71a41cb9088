// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace calibrd::sim {

/// Triangles in the frame of the body that owns them. Metres.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  bool solid = false;  ///< closed, all triangles counter-clockwise from outside: what faces away is never seen
};

/// How a body looks in the near infrared.
struct Surface {
  float albedo = 0.5F;       ///< part of the light that comes back, 0..1
  float texture = 0.0F;      ///< relative depth of the mottling on top of it, 0..1
  std::uint32_t seed = 0;    ///< makes one body's mottling differ from another's
};

/// Whether the triangles close, turned outwards: every edge runs once each way between the same points.
bool is_solid(const Mesh& mesh);

/// Appends `part`, so that one body can be built of several solids.
void append(Mesh& mesh, const Mesh& part);

/// Axis-parallel box about the origin.
Mesh make_box(const Eigen::Vector3d& size_m);

/// Cylinder about the z axis, centred on the origin.
Mesh make_cylinder(double radius_m, double length_m, int sides = 24);

/// Cylinder about the z axis with half spheres at both ends; `length_m` is between their centres.
Mesh make_capsule(double radius_m, double length_m, int sides = 16);

}  // namespace calibrd::sim
