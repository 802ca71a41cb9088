// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Writes the meshes of the demo arm: make_demo_robot FOLDER
#include <cstdio>
#include <filesystem>
#include <string>

#include "config/demo_robot/links.hpp"
#include "config/demo_robot/stl.hpp"

int main(int argc, char** argv) {
  using namespace calibrd;
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_demo_robot FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  const struct {
    const char* name;
    TriangleMesh mesh_mm;
  } links[] = {{"base", demo::base()},   {"turret", demo::turret()},   {"lower_arm", demo::lower_arm()},
               {"elbow", demo::elbow()}, {"forearm", demo::forearm()}, {"wrist", demo::wrist()},
               {"hand", demo::hand()},   {"flange", demo::flange()}};
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  for (const auto& [name, mesh_mm] : links) {
    const auto file = folder / (std::string(name) + ".stl");
    if (demo::write_stl(file, mesh_mm)) continue;
    std::fprintf(stderr, "cannot write %s\n", file.c_str());
    return 1;
  }
}
