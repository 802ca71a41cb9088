// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "config/demo_robot/write_links.hpp"

#include <cstdio>
#include <filesystem>
#include <string>

#include "config/demo_robot/stl.hpp"

namespace calibrd::demo {

int write_links(int argc, char** argv, const std::vector<NamedMesh>& links) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  for (const auto& [name, mesh_mm] : links) {
    const auto file = folder / (std::string(name) + ".stl");
    if (write_stl(file, mesh_mm)) continue;
    std::fprintf(stderr, "cannot write %s\n", file.c_str());
    return 1;
  }
  return 0;
}

}  // namespace calibrd::demo
