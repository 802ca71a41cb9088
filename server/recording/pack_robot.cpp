// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/recording/pack_robot.hpp"

#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "core/robot/mesh_path.hpp"

namespace calibrd {
namespace {

namespace fs = std::filesystem;

constexpr const char* kName = "robot.urdf";

std::set<std::string> mesh_references(const std::string& urdf) {
  static const std::regex mesh(R"rx(<mesh[^>]*\sfilename\s*=\s*["']([^"']+)["'])rx");
  std::set<std::string> references;
  for (std::sregex_iterator match(urdf.begin(), urdf.end(), mesh), end; match != end; ++match)
    references.insert((*match)[1]);
  return references;
}

/// Where in the folder a reference is looked up; empty for one that points outside of it.
fs::path place_of(const std::string& reference) {
  constexpr std::string_view kPackage = "package://";
  const fs::path place = reference.starts_with(kPackage) ? reference.substr(kPackage.size()) : reference;
  const auto normal = place.lexically_normal();
  const bool inside = !normal.empty() && normal.is_relative() && *normal.begin() != "..";
  return inside && reference.find("file://") != 0 ? normal : fs::path();
}

Status place_copy(const fs::path& from, const fs::path& to) {
  std::error_code failure;
  fs::create_directories(to.parent_path(), failure);
  if (!failure) fs::copy_file(from, to, fs::copy_options::overwrite_existing, failure);
  if (failure) return Error{failure, from.string() + " to " + to.string()};
  return Done{};
}

}  // namespace

Status pack_robot(const fs::path& urdf, std::span<const fs::path> search_paths, const fs::path& folder) {
  std::ostringstream text;
  text << std::ifstream(urdf).rdbuf();
  for (const auto& reference : mesh_references(text.str())) {
    const auto place = place_of(reference);
    if (place.empty()) continue;
    const auto mesh = find_mesh(reference, urdf, search_paths);
    if (!mesh) return mesh.error();
    if (auto copied = place_copy(*mesh, folder / place); !copied) return copied;
  }
  return place_copy(urdf, folder / kName);
}

}  // namespace calibrd
