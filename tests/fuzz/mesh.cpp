// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// A mesh file. Input: which kind, then the file.
#include <array>

#include "core/robot/mesh_file.hpp"
#include "tests/core/robot/scratch_folder.hpp"
#include "tests/fuzz/fuzz.hpp"

// Assimp loses some memory when it gives up a file; a robot model is read once, so it does not add up.
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp"; }

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace calibrd;
  static const test::ScratchFolder scratch;
  constexpr std::array kNames{"mesh.stl", "mesh.dae", "mesh.obj"};
  fuzz::Input input(data, size);
  const auto* const name = kNames[input.byte() % kNames.size()];
  const auto mesh = read_mesh_file(scratch.write(name, input.text()));
  if (!mesh) {
    fuzz::require(!mesh.error().message().empty(), "an error says something");
    return 0;
  }
  fuzz::require(!mesh->triangles.empty(), "a mesh has triangles");
  for (const auto& vertex : mesh->vertices) fuzz::require(vertex.allFinite(), "a mesh has finite corners");
  for (const auto& triangle : mesh->triangles)
    for (const auto corner : triangle)
      fuzz::require(corner < mesh->vertices.size(), "a triangle has corners");
  return 0;
}
