// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/robot/mesh_path.hpp"

#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "core/robot/robot_model_error.hpp"

namespace calibrd {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFileScheme = "file://";
constexpr std::string_view kPackageScheme = "package://";

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

fs::path folder_of(const fs::path& urdf) {
  std::error_code failed;
  const fs::path absolute = fs::absolute(urdf, failed);
  return (failed ? urdf : absolute).lexically_normal().parent_path();
}

std::vector<fs::path> folders_above(fs::path folder) {
  std::vector<fs::path> above;
  while (folder.has_parent_path() && folder != folder.parent_path())
    above.push_back(folder = folder.parent_path());
  return above;
}

/// The last name of a folder, with or without a slash at its end.
fs::path name_of(const fs::path& folder) {
  const fs::path normal = folder.lexically_normal();
  return normal.has_filename() ? normal.filename() : normal.parent_path().filename();
}

std::optional<fs::path> find_in_package(const fs::path& folder, const fs::path& package,
                                        const fs::path& rest) {
  if (fs::path file = folder / package / rest; is_file(file)) return file;
  if (name_of(folder) == package)
    if (fs::path file = folder / rest; is_file(file)) return file;
  return std::nullopt;
}

std::optional<fs::path> find_package_file(std::string_view reference, const fs::path& urdf_folder,
                                          std::vector<fs::path> folders) {
  const auto slash = reference.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const fs::path package(reference.substr(0, slash)), rest(reference.substr(slash + 1));
  const auto above = folders_above(urdf_folder);
  folders.insert(folders.end(), above.begin(), above.end());
  for (const auto& folder : folders)
    if (auto file = find_in_package(folder, package, rest)) return file;
  return std::nullopt;
}

std::optional<fs::path> find_plain_file(const fs::path& path, std::span<const fs::path> folders) {
  if (path.is_absolute()) return is_file(path) ? std::optional(path) : std::nullopt;
  for (const auto& folder : folders)
    if (fs::path file = folder / path; is_file(file)) return file;
  return std::nullopt;
}

/// Each folder once, however it is written.
std::string listing(std::span<const fs::path> folders) {
  std::string text;
  std::set<fs::path> named;
  for (const auto& folder : folders) {
    std::error_code ignored;
    const auto canonical = fs::weakly_canonical(folder, ignored);
    if (named.insert(canonical.empty() ? folder : canonical).second)
      text += (text.empty() ? "" : ", ") + folder.string();
  }
  return text;
}

}  // namespace

Result<fs::path> find_mesh(const std::string& reference, const fs::path& urdf,
                           std::span<const fs::path> search_paths) {
  const fs::path urdf_folder = folder_of(urdf);
  std::vector<fs::path> folders{urdf_folder};
  folders.insert(folders.end(), search_paths.begin(), search_paths.end());

  std::optional<fs::path> found;
  if (reference.starts_with(kPackageScheme))
    found =
        find_package_file(std::string_view(reference).substr(kPackageScheme.size()), urdf_folder, folders);
  else if (reference.starts_with(kFileScheme))
    found = find_plain_file(reference.substr(kFileScheme.size()), folders);
  else
    found = find_plain_file(reference, folders);
  if (found) return *found;
  return Error{RobotModelError::mesh_not_found,
               "'" + reference + "' of " + urdf.string() + " (looked in " + listing(folders) + ")"};
}

}  // namespace calibrd
