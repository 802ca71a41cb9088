// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/robot/triangle_mesh.hpp"

/// The links of the test arm, each in its link frame (see test_arm6.urdf), mm.
namespace calibrd::test::arm6 {

TriangleMesh foot();
TriangleMesh shoulder();
TriangleMesh upper_arm();
TriangleMesh elbow();
TriangleMesh forearm();
TriangleMesh wrist();
TriangleMesh tool();

}  // namespace calibrd::test::arm6
