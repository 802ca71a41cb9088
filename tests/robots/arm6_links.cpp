// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/robots/arm6_links.hpp"

#include "config/demo_robot/shapes.hpp"

namespace calibrd::test::arm6 {

using namespace demo;

/// A square column on a plate, the connector box on +y.
TriangleMesh foot() {
  const Section column[] = {{at(0, 0, 18), {112, 96, 14}},
                            {at(0, 0, 60), {98, 88, 18}},
                            {at(4, 0, 150), {88, 84, 30}},
                            {at(0, 0, 196), circle(90)},
                            {at(0, 0, 212), circle(90)}};
  Part part;
  part.add(prism({140, 118, 12}, 20, 2), at(-8, 0, 0)).add(loft(column));
  part.add(corner_bolts(122, 100, {10, 12}), at(-8, 0, 19));
  part.add(prism({38, 50, 5}, 46, 4), along_y(-20, 84, 74));
  part.add(prism(circle(13), 22, 2), along_y(-38, 129, 92));
  part.add(prism(circle(9), 18, 2), along_y(0, 129, 60));
  return part.mesh();
}

/// Turns on axis 1 (z); a block ahead of it carries axis 2 (y) on its -y side, the motor stands behind.
TriangleMesh shoulder() {
  const ProfilePoint plate[] = {{-46, 84}, {-42, 92}, {-14, 92}, {-8, 86}};
  const Section block[] = {{at(0, -6, -12), {84, 66, 26}},
                           {at(14, -22, 34), {86, 56, 24}},
                           {at(52, -44, 96), {82, 40, 20}},
                           {at(70, -50, 160), {66, 34, 18}},
                           {at(74, -50, 196), {44, 28, 14}}};
  Part part;
  part.add(turned(plate)).add(loft(block));
  part.add(prism(circle(78), 78, 6), along_minus_y(75, -12, 130));
  part.add(bolt_circle(8, 60, {5, 5}, 11), along_minus_y(75, -89, 130));
  part.add(prism({38, 44, 8}, 156, 6), at(-52, 20, -12));
  part.add(prism(circle(30), 40, 4), at(-52, 20, 142));
  return part.mesh();
}

/// A flat beam on the +y side from axis 2 to axis 3 (both y).
TriangleMesh upper_arm() {
  const Section beam[] = {{at(-4, 32, -60), {58, 26, 10}},
                          {at(0, 34, 20), {74, 30, 12}},
                          {at(10, 36, 190), {56, 27, 12}},
                          {at(0, 34, 330), {58, 26, 12}},
                          {at(-2, 32, 430), {44, 22, 10}}};
  Part part;
  part.add(loft(beam));
  part.add(prism(circle(76), 74, 6), along_y(0, -8, 0)).add(prism(circle(62), 60, 5), along_y(0, 2, 380));
  part.add(bolt_circle(6, 54, {6, 5}, 0), along_y(0, 65, 0));
  part.add(prism({26, 84, 8}, 14, 3), along_y(14, 60, 186));  // cover
  part.add(corner_bolts(18, 74, {3.5, 3}), along_y(14, 73.5, 186));
  part.add(tube({Eigen::Vector3d(-70, 30, 20), {-118, 40, 110}, {-112, 30, 280}, {-52, 24, 350}}, 13));
  return part.mesh();
}

/// Turns on axis 3 (y) on the -y side; a box above it holds axis 4 (x), two unlike motors at its back.
TriangleMesh elbow() {
  const Section box[] = {{along_x(-104, -50, 74), {52, 44, 12}},
                         {along_x(-90, -50, 76), {60, 52, 14}},
                         {along_x(-10, -48, 76), {66, 56, 18}},
                         {along_x(48, -45, 80), {58, 58, 36}},
                         {along_x(86, -45, 80), circle(56)}};
  Part part;
  part.add(prism(circle(60), 100, 6), along_minus_y(0, -2, 0)).add(loft(box));
  part.add(prism(circle(44), 6, 2), along_minus_y(0, -101, 0));
  part.add(bolt_circle(5, 36, {4, 4}, 18), along_minus_y(0, -106, 0));
  part.add(prism(circle(27), 88, 5), along_minus_x(-98, -26, 96));
  part.add(prism({22, 20, 5}, 52, 4), along_minus_x(-98, -76, 58));
  part.add(prism({60, 18, 6}, 16, 3), at(-26, -70, 138));
  return part.mesh();
}

/// Turns on axis 4 (x); its end lies on the +y side of axis 5 (y).
TriangleMesh forearm() {
  const Section body[] = {{along_x(4, 0, 0), circle(52)},      {along_x(40, 0, 0), circle(52)},
                          {along_x(74, 8, 4), {50, 44, 22}},   {along_x(190, 22, 6), {42, 32, 14}},
                          {along_x(270, 30, 0), {40, 24, 10}}, {along_x(352, 32, 0), {28, 20, 10}}};
  Part part;
  part.add(loft(body)).add(prism(circle(45), 58, 5), along_y(320, 2, 0));
  part.add(bolt_circle(6, 34, {4, 4}, 0), along_y(320, 59, 0));
  part.add(prism({44, 20, 6}, 16, 4), at(150, 18, 44));
  part.add(tube({Eigen::Vector3d(40, -46, 10), {90, -66, 30}, {190, -30, 44}, {262, 10, 36}}, 10));
  return part.mesh();
}

/// A hub on axis 5 (y), on its -y side, and the neck that holds axis 6 (x), 42 mm beside axis 4.
TriangleMesh wrist() {
  const Section neck[] = {{along_x(-34, -44, 2), {32, 28, 10}},
                          {along_x(24, -44, 6), {38, 32, 14}},
                          {along_x(66, -42, 10), {34, 34, 24}},
                          {along_x(98, -42, 10), circle(36)}};
  Part part;
  part.add(prism(circle(44), 80, 5), along_minus_y(0, -3, 0)).add(loft(neck));
  part.add(bolt_circle(5, 30, {4, 3.5}, 40), along_minus_y(0, -82.5, 0));
  part.add(prism({26, 12, 4}, 20, 3), at(48, -34, 40));
  return part.mesh();
}

/// A flange with a bracket and two unlike fingers: a hand that looks different from every side. Axis 6: x.
TriangleMesh tool() {
  Part part;
  part.add(prism(circle(38), 16, 2), along_x(-5, 0, 0))
      .add(bolt_circle(6, 28, {4, 4}, 12), along_x(10.5, 0, 0));
  part.add(prism({34, 48, 6}, 18, 3), along_x(10, 14, 4));
  part.add(prism({12, 9, 2}, 92, 2), along_x(26, 50, 14));
  part.add(prism({16, 7, 2}, 66, 2), along_x(26, -20, -8));
  part.add(prism({14, 22, 3}, 40, 2), along_x(26, 12, -22));
  return part.mesh();
}

}  // namespace calibrd::test::arm6
