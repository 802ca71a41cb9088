// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "core/robot/triangle_mesh.hpp"

namespace calibrd::demo {

struct NamedMesh {
  const char* name;
  TriangleMesh mesh_mm;
};

/// The program that makes a robot: writes each link as NAME.stl into the folder that is its one argument.
/// Returns the exit status.
int write_links(int argc, char** argv, const std::vector<NamedMesh>& links);

}  // namespace calibrd::demo
