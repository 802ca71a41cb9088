// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

#include "core/robot/triangle_mesh.hpp"

/// The shapes the demo robot is put together from. Lengths in mm (turned into metres when written), angles in
/// degrees. Every shape is closed, its normals outward.
namespace calibrd::demo {

using Frame = Eigen::Affine3d;

/// A rectangle with round corners in the xy plane, centred; a circle when all three are equal.
struct Outline {
  double half_x, half_y, corner;
  int corner_points = 9;

  Outline inset(double by) const;
  /// Counter-clockwise, 4 · corner_points points, the same count for outlines that are to be joined.
  std::vector<Eigen::Vector3d> points() const;
};

inline Outline circle(double radius) { return {radius, radius, radius}; }

/// An outline and where it lies: the xy plane of `frame`, whose z axis points along the loft.
struct Section {
  Frame frame;
  Outline outline;
};

/// The skin over sections in a row, closed by the first and the last.
TriangleMesh loft(std::span<const Section> sections);

/// An outline drawn along z from 0 to `height`, both end edges rounded in `fillet_steps` facets.
TriangleMesh prism(const Outline& outline, double height, double fillet, int fillet_steps = 3);

struct ProfilePoint {
  double z, radius;
};

/// A profile turned about z, z ascending.
TriangleMesh turned(std::span<const ProfilePoint> profile);

/// A round tube along a cubic Bézier curve.
TriangleMesh tube(const std::array<Eigen::Vector3d, 4>& curve, double radius);

struct BoltHead {
  double radius, height;
};

/// `count` bolt heads on the xy plane, evenly round a circle.
TriangleMesh bolt_circle(int count, double circle_radius, BoltHead head, double first_deg);

/// Four bolt heads on the xy plane at (±half_x, ±half_y).
TriangleMesh corner_bolts(double half_x, double half_y, BoltHead head);

/// Frames at a point whose z axis points along an axis of the parent. Under a frame turned in the xz plane, z
/// is x or z turned about y and the outline's y stays the parent's y.
Frame at(double x, double y, double z);
Frame along_x(double x, double y, double z);
Frame along_minus_x(double x, double y, double z);
Frame along_y(double x, double y, double z);
Frame along_minus_y(double x, double y, double z);
Frame pitched(double x, double y, double z, double pitch_deg);

/// A link under construction: shapes put into its frame.
class Part {
 public:
  Part& add(const TriangleMesh& shape, const Frame& frame = Frame::Identity());
  const TriangleMesh& mesh() const { return mesh_; }

 private:
  TriangleMesh mesh_;
};

}  // namespace calibrd::demo
