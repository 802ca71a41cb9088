// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "config/demo_robot/links.hpp"
#include "config/demo_robot/shapes.hpp"

namespace calibrd::demo {

/// Foot, pedestal, and the box at the back where power, signals and air enter. Axis S: z.
TriangleMesh base() {
  const Section pedestal[] = {{at(-6, 0, 16), {86, 86, 40}}, {at(-5, 0, 24), {82, 82, 42}},
                              {at(-2, 0, 70), {74, 74, 58}}, {at(0, 0, 112), circle(71)},
                              {at(0, 0, 140), circle(76)},   {at(0, 0, 172), circle(76)},
                              {at(0, 0, 176), circle(73)},   {at(0, 0, 179.5), circle(70)}};
  Part part;
  part.add(prism({98, 106, 28}, 18, 3), at(-30, 0, 0)).add(loft(pedestal));
  part.add(corner_bolts(80, 88, {9, 10}), at(-30, 0, 17));
  part.add(prism({42, 52, 8}, 112, 5), at(-86, 8, 17));
  part.add(prism({24, 16, 4}, 9, 2), along_minus_x(-126, 30, 92));   // signal plug
  part.add(prism(circle(15), 24, 3), along_minus_x(-126, -22, 88));  // power plug
  part.add(prism(circle(7), 16, 2), along_minus_x(-126, -24, 50));   // air
  part.add(prism(circle(7), 16, 2), along_minus_x(-126, -4, 50));    // air
  part.add(prism({20, 34, 6}, 8, 2), along_y(24, 70, 70));           // name plate
  return part.mesh();
}

/// A drum under the arm, with one cheek beside it on +y that carries axis L (y).
TriangleMesh turret() {
  const ProfilePoint drum[] = {{-142, 74}, {-138, 79}, {-112, 79}, {-106, 76},
                               {-94, 76},  {-74, 72},  {-66, 64},  {-63, 56}};
  const Section cheek[] = {{at(0, 44, -128), {60, 26, 12}}, {at(0, 50, -112), {66, 27, 14}},
                           {at(0, 58, -60), {64, 19, 14}},  {at(0, 63, 0), {58, 17, 14}},
                           {at(0, 63, 34), {46, 16, 12}},   {at(0, 62, 44), {36, 12, 10}}};
  Part part;
  part.add(turned(drum)).add(loft(cheek));
  part.add(prism(circle(66), 36, 5), along_y(0, 44, 0));
  part.add(prism(circle(50), 7, 2), along_y(0, 78, 0)).add(bolt_circle(8, 42, {4, 4}, 10), along_y(0, 84, 0));
  part.add(prism({18, 40, 10}, 56, 6), at(-70, -6, -136));  // junction box at the back
  part.add(tube({Eigen::Vector3d(-74, 10, -90), {-96, 20, -30}, {-84, 62, 10}, {-40, 64, 20}}, 9));
  return part.mesh();
}

/// A hub on axis L (y) and the tube that rises from it to axis E (z).
TriangleMesh lower_arm() {
  const Section column[] = {{at(0, -16, -20), {50, 46, 24}}, {at(0, -14, 30), {54, 46, 26}},
                            {at(0, -10, 78), {56, 50, 34}},  {at(0, -4, 122), {60, 58, 50}},
                            {at(0, 0, 150), circle(62)},     {at(0, 0, 168), circle(64)},
                            {at(0, 0, 178), circle(64)},     {at(0, 0, 183), circle(60)}};
  Part part;
  part.add(prism(circle(69), 120, 6), along_y(0, -73, 0)).add(loft(column));
  part.add(prism(circle(54), 6, 2), along_minus_y(0, -72, 0))
      .add(bolt_circle(7, 45, {4.5, 4}, 20), along_minus_y(0, -77, 0));
  part.add(prism({44, 30, 10}, 12, 4), along_x(50, -8, 92));  // cover of the E drive
  part.add(corner_bolts(35, 21, {3.5, 3}), along_x(61.5, -8, 92));
  part.add(tube({Eigen::Vector3d(-58, -40, 4), {-96, -34, 50}, {-92, -20, 120}, {-54, -10, 160}}, 10));
  return part.mesh();
}

/// Turns on axis E (z) and carries axis U (y), 85 mm ahead, in a cheek on +y.
TriangleMesh elbow() {
  const ProfilePoint collar[] = {{-113, 64}, {-109, 68.5}, {-92, 68.5}, {-88, 66},
                                 {-76, 66},  {-62, 58},    {-54, 44},   {-51, 30}};
  const Section cheek[] = {{along_y(10, 14, -42), {46, 52, 20}}, {along_y(14, 22, -38), {52, 62, 26}},
                           {along_y(22, 40, -30), {54, 76, 32}}, {along_y(34, 56, -20), {50, 78, 36}},
                           {along_y(42, 64, -14), {44, 68, 34}}, {along_y(44, 68, -12), {38, 60, 30}}};
  Part part;
  part.add(turned(collar)).add(loft(cheek));
  part.add(prism(circle(54), 55, 5), along_y(85, 18, 0));
  part.add(prism(circle(40), 5, 1.5), along_y(85, 71, 0))
      .add(bolt_circle(6, 33, {4, 3.5}, 0), along_y(85, 75.5, 0));
  part.add(prism(circle(27), 76, 5), at(-8, 34, -22));  // motor of axis U
  part.add(prism({20, 30, 8}, 46, 5), at(-52, 16, -70));
  return part.mesh();
}

}  // namespace calibrd::demo
