// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "config/demo_robot/links.hpp"
#include "config/demo_robot/shapes.hpp"

namespace calibrd::demo {

/// A hub on axis U (y) and a body that bends up to axis R (x), 60 mm above.
TriangleMesh forearm() {
  const Section body[] = {{pitched(-20, -28, -6, 60), {44, 40, 26}}, {pitched(14, -26, 16, 58), {48, 42, 30}},
                          {pitched(46, -18, 38, 66), {50, 44, 34}},  {pitched(76, -6, 54, 80), {52, 50, 44}},
                          {along_x(98, 0, 60), circle(54)},          {along_x(132, 0, 60), circle(54)},
                          {along_x(140, 0, 60), circle(52)},         {along_x(145, 0, 60), circle(48)}};
  Part part;
  part.add(prism(circle(56.5), 94, 6), along_y(0, -74, 0)).add(loft(body));
  part.add(prism(circle(43), 6, 2), along_minus_y(0, -72, 0))
      .add(bolt_circle(6, 36, {4, 4}, 15), along_minus_y(0, -77, 0));
  part.add(prism({30, 34, 10}, 16, 4), along_y(104, 42, 62));  // cover of the R drive
  part.add(corner_bolts(22, 26, {3, 3}), along_y(104, 57.5, 62));
  part.add(tube({Eigen::Vector3d(-12, -50, 44), {4, -46, 112}, {70, -24, 136}, {112, -10, 100}}, 9));
  return part.mesh();
}

/// Turns on axis R (x); a cheek on -y carries axis B (y).
TriangleMesh wrist() {
  const ProfilePoint sleeve[] = {{-136, 48}, {-132, 51}, {-116, 51}, {-110, 48},
                                 {-84, 47},  {-66, 46},  {-52, 40},  {-44, 30}};
  const Section cheek[] = {{along_minus_y(-52, -16, 0), {38, 34, 14}},
                           {along_minus_y(-44, -26, 0), {40, 44, 18}},
                           {along_minus_y(-32, -40, 0), {38, 58, 24}},
                           {along_minus_y(-26, -52, 0), {34, 56, 26}},
                           {along_minus_y(-24, -57, 0), {29, 50, 24}}};
  Part part;
  std::vector<Section> turned_sleeve;
  for (const auto& [x, radius] : sleeve) turned_sleeve.push_back({along_x(x, 0, 0), circle(radius)});
  part.add(loft(turned_sleeve)).add(loft(cheek));
  part.add(prism(circle(39), 40, 4), along_minus_y(0, -20, 0));
  part.add(bolt_circle(5, 28, {3.5, 3}, 18), along_minus_y(0, -59.5, 0));
  part.add(prism({22, 16, 6}, 58, 4), along_x(-112, 14, 44));  // motor of axis B
  part.add(tube({Eigen::Vector3d(-100, 40, -14), {-84, 66, -20}, {-60, 62, -24}, {-52, 30, -18}}, 6));
  return part.mesh();
}

/// A hub on axis B (y) and the neck that holds the flange.
TriangleMesh hand() {
  const Section neck[] = {
      {along_x(-8, 8, 0), {32, 28, 14}}, {along_x(28, 7, 0), {36, 32, 18}}, {along_x(58, 4, 0), {37, 35, 26}},
      {along_x(84, 0, 0), circle(36)},   {along_x(104, 0, 0), circle(36)},  {along_x(110, 0, 0), circle(41)},
      {along_x(128, 0, 0), circle(41)},  {along_x(133, 0, 0), circle(39)},  {along_x(136, 0, 0), circle(35)}};
  Part part;
  part.add(prism(circle(41), 66, 5), along_y(0, -22, 0)).add(loft(neck));
  part.add(prism(circle(30), 6, 2), along_y(0, 43, 0))
      .add(bolt_circle(5, 23, {3.5, 3}, 8), along_y(0, 48.5, 0));
  part.add(prism({17, 28, 6}, 22, 4), along_y(62, 26, 6));  // cover of the T drive
  part.add(prism(circle(8), 14, 2), at(76, 10, 34));        // connector for the tool
  part.add(prism({12, 22, 5}, 12, 3), pitched(52, -6, -30, 180));
  return part.mesh();
}

/// The tool flange: pilot, four threads' bosses and the pin that keeps tools from turning. Axis T: x.
TriangleMesh flange() {
  const ProfilePoint disc[] = {{-4, 30},    {-2, 34},  {0, 36},   {1.5, 39},    {5, 39},
                               {6.5, 37.5}, {6.5, 34}, {8, 31.5}, {10.5, 31.5}, {11, 31}};
  Part part;
  std::vector<Section> sections;
  for (const auto& [x, radius] : disc) sections.push_back({along_x(x, 0, 0), circle(radius)});
  part.add(loft(sections));
  part.add(prism(circle(10), 4, 1), along_x(9, 0, 0));
  part.add(bolt_circle(4, 20, {4, 3.5}, 45), along_x(10.5, 0, 0));
  part.add(prism(circle(2.5), 5, 0.5), along_x(10.5, 20, 0));  // dowel
  part.add(prism({8, 4, 1.5}, 9, 1), along_x(0, 0, 37));       // zero mark
  return part.mesh();
}

}  // namespace calibrd::demo
