// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/robot/triangle_mesh.hpp"

/// The links of the demo arm, each in its link frame (see demo_arm7.urdf), mm.
namespace calibrd::demo {

TriangleMesh base();
TriangleMesh turret();
TriangleMesh lower_arm();
TriangleMesh elbow();
TriangleMesh forearm();
TriangleMesh wrist();
TriangleMesh hand();
TriangleMesh flange();

}  // namespace calibrd::demo
