// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "core/robot/triangle_mesh.hpp"

namespace calibrd::api {

/// The mesh as a binary STL file (80 bytes of header, a count, 50 bytes for each triangle, little-endian), in
/// metres as the robotics world has it. The format states no unit.
std::string binary_stl(const TriangleMesh& mesh);

}  // namespace calibrd::api
