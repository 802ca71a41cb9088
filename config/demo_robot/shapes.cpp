// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "config/demo_robot/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace calibrd::demo {
namespace {

constexpr int kTubeSteps = 20;

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

Frame turned_about(const Eigen::Vector3d& axis, double angle_deg, double x, double y, double z) {
  return Frame(Eigen::Translation3d(x, y, z) * Eigen::AngleAxisd(radians(angle_deg), axis));
}

Eigen::Vector3d bezier(const std::array<Eigen::Vector3d, 4>& curve, double t) {
  const double s = 1 - t;
  return s * s * s * curve[0] + 3 * s * s * t * curve[1] + 3 * s * t * t * curve[2] + t * t * t * curve[3];
}

Eigen::Vector3d bezier_direction(const std::array<Eigen::Vector3d, 4>& curve, double t) {
  const double s = 1 - t;
  return (s * s * (curve[1] - curve[0]) + 2 * s * t * (curve[2] - curve[1]) + t * t * (curve[3] - curve[2]))
      .normalized();
}

TriangleMesh bolt_head(const BoltHead& head) {
  Outline outline = circle(head.radius);
  outline.corner_points = 2;
  return prism(outline, head.height, 0.2 * head.radius, 1);
}

}  // namespace

Outline Outline::inset(double by) const {
  return {half_x - by, half_y - by, std::max(corner - by, 0.1), corner_points};
}

std::vector<Eigen::Vector3d> Outline::points() const {
  std::vector<Eigen::Vector3d> points;
  for (int quarter = 0; quarter < 4; ++quarter)
    for (int step = 0; step < corner_points; ++step) {
      // Half steps, so that no two corners share a point when the straight sides between them vanish.
      const double angle = (quarter + (step + 0.5) / corner_points) * std::numbers::pi / 2;
      const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
      points.emplace_back(std::copysign(half_x - corner, direction.x()) + corner * direction.x(),
                          std::copysign(half_y - corner, direction.y()) + corner * direction.y(), 0);
    }
  return points;
}

TriangleMesh loft(std::span<const Section> sections) {
  TriangleMesh mesh;
  for (const auto& section : sections)
    for (const auto& point : section.outline.points())
      mesh.vertices.emplace_back((section.frame * point).cast<float>());
  const auto steps = static_cast<std::uint32_t>(4 * sections.front().outline.corner_points);
  const auto top = static_cast<std::uint32_t>(mesh.vertices.size());
  const std::uint32_t bottom = top + 1, last = top - steps;
  mesh.vertices.emplace_back(sections.back().frame.translation().cast<float>());
  mesh.vertices.emplace_back(sections.front().frame.translation().cast<float>());
  for (std::uint32_t step = 0; step < steps; ++step) {
    const std::uint32_t next = (step + 1) % steps;
    mesh.triangles.push_back({bottom, next, step});
    for (std::uint32_t ring = 0; ring < last; ring += steps) {
      mesh.triangles.push_back({ring + step, ring + next, ring + steps + next});
      mesh.triangles.push_back({ring + step, ring + steps + next, ring + steps + step});
    }
    mesh.triangles.push_back({top, last + step, last + next});
  }
  return mesh;
}

TriangleMesh prism(const Outline& outline, double height, double fillet, int fillet_steps) {
  std::vector<Section> sections;
  const auto add_edge = [&](int step, double z_end, double inward) {
    const double angle = std::numbers::pi / 2 * step / fillet_steps;
    const double z = z_end + inward * fillet * (1 - std::cos(angle));
    sections.push_back({at(0, 0, z), outline.inset(fillet * (1 - std::sin(angle)))});
  };
  for (int step = 0; step <= fillet_steps; ++step) add_edge(step, 0, 1);
  for (int step = fillet_steps; step >= 0; --step) add_edge(step, height, -1);
  return loft(sections);
}

TriangleMesh turned(std::span<const ProfilePoint> profile) {
  std::vector<Section> sections;
  for (const auto& [z, radius] : profile) sections.push_back({at(0, 0, z), circle(radius)});
  return loft(sections);
}

TriangleMesh tube(const std::array<Eigen::Vector3d, 4>& curve, double radius) {
  Outline outline = circle(radius);
  outline.corner_points = 4;
  std::vector<Section> sections;
  Eigen::Matrix3d axes =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), bezier_direction(curve, 0))
          .toRotationMatrix();
  for (int step = 0; step <= kTubeSteps; ++step) {
    const double t = static_cast<double>(step) / kTubeSteps;
    // Carry the outline along by the smallest turn, so that the skin does not twist.
    axes =
        Eigen::Quaterniond::FromTwoVectors(axes.col(2), bezier_direction(curve, t)).toRotationMatrix() * axes;
    Frame frame = Frame::Identity();
    frame.linear() = axes;
    frame.translation() = bezier(curve, t);
    sections.push_back({frame, outline});
  }
  return loft(sections);
}

TriangleMesh bolt_circle(int count, double circle_radius, BoltHead head, double first_deg) {
  TriangleMesh mesh;
  for (int bolt = 0; bolt < count; ++bolt) {
    const double angle = radians(first_deg + 360.0 * bolt / count);
    append(mesh, bolt_head(head), at(circle_radius * std::cos(angle), circle_radius * std::sin(angle), 0));
  }
  return mesh;
}

TriangleMesh corner_bolts(double half_x, double half_y, BoltHead head) {
  TriangleMesh mesh;
  for (const double x : {-half_x, half_x})
    for (const double y : {-half_y, half_y}) append(mesh, bolt_head(head), at(x, y, 0));
  return mesh;
}

Frame at(double x, double y, double z) { return Frame(Eigen::Translation3d(x, y, z)); }
Frame along_x(double x, double y, double z) { return turned_about(Eigen::Vector3d::UnitY(), 90, x, y, z); }
Frame along_minus_x(double x, double y, double z) {
  return turned_about(Eigen::Vector3d::UnitY(), -90, x, y, z);
}
Frame along_y(double x, double y, double z) { return turned_about(Eigen::Vector3d::UnitX(), -90, x, y, z); }
Frame along_minus_y(double x, double y, double z) {
  return turned_about(Eigen::Vector3d::UnitX(), 90, x, y, z);
}
Frame pitched(double x, double y, double z, double pitch_deg) {
  return turned_about(Eigen::Vector3d::UnitY(), pitch_deg, x, y, z);
}

Part& Part::add(const TriangleMesh& shape, const Frame& frame) {
  append(mesh_, shape, frame);
  return *this;
}

}  // namespace calibrd::demo
