// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/pose_basis.hpp"

#include <array>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <map>
#include <span>
#include <sstream>

namespace calibrd {
namespace {

constexpr std::size_t kAxes = 10;  // simple_message carries ten values

/// FNV-1a, 64 bits: tells configurations apart, and is no protection against anybody.
class Fingerprint {
 public:
  void add(std::span<const std::byte> bytes) {
    for (const auto byte : bytes) hash_ = (hash_ ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3ULL;
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(std::as_bytes(std::span(values)));
  }
  std::string text() const {
    std::array<char, 24> digits{};
    std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(hash_));
    return digits.data();
  }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

std::string number(double value) {
  std::array<char, 32> buffer{};
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

std::string fingerprint_of_text(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  const auto content = text.str();
  Fingerprint fingerprint;
  fingerprint.add(std::as_bytes(std::span(content)));
  return fingerprint.text();
}

std::string fingerprint_of_surfaces(const RobotModel& model) {
  Fingerprint fingerprint;
  for (const auto& link : model.links()) {
    for (const auto& vertex : link.surface.vertices)
      fingerprint.add(std::as_bytes(std::span(vertex.data(), 3)));
    fingerprint.add(link.surface.triangles);
  }
  return fingerprint.text();
}

/// The mapping is affine: its values at zero and at one of each axis are all there is to it.
std::string fingerprint_of_mapping(const JointMapping& mapping) {
  Fingerprint fingerprint;
  for (std::size_t axis = 0; axis <= kAxes; ++axis) {
    std::vector<double> controller(kAxes, 0.0);
    if (axis < kAxes) controller[axis] = 1;
    if (const auto positions = mapping.positions(controller)) fingerprint.add(*positions);
  }
  return fingerprint.text();
}

std::map<std::string, std::string> lines_of(const std::string& basis) {
  std::map<std::string, std::string> lines;
  std::istringstream text(basis);
  for (std::string line; std::getline(text, line);)
    if (const auto colon = line.find(": "); colon != std::string::npos)
      lines[line.substr(0, colon)] = line.substr(colon + 2);
  return lines;
}

}  // namespace

std::string robot_basis(const std::filesystem::path& urdf, const RobotModel& model,
                        const JointMapping& mapping) {
  return "robot model: " + fingerprint_of_text(urdf) + "\nrobot meshes: " + fingerprint_of_surfaces(model) +
         "\nbase link: " + model.base_link() + "\njoint mapping: " + fingerprint_of_mapping(mapping) + "\n";
}

std::string camera_basis(const CameraModel& camera, bool mirror) {
  std::ostringstream text;
  text << "intrinsics: " << camera.width << 'x' << camera.height << " fx " << number(camera.fx) << " fy "
       << number(camera.fy) << " cx " << number(camera.cx) << " cy " << number(camera.cy) << " distortion";
  for (const double k : camera.distortion) text << ' ' << number(k);
  text << "\nmirror: " << (mirror ? "true" : "false") << '\n';
  return text.str();
}

std::string basis_changes(const std::string& before, const std::string& now) {
  const auto was = lines_of(before);
  std::string changes;
  for (const auto& [name, value] : lines_of(now)) {
    const auto found = was.find(name);
    if (found != was.end() && found->second == value) continue;
    const auto then = found == was.end() ? "not recorded" : found->second;
    changes.append(changes.empty() ? "" : ", ").append(name);
    changes.append(" (now ").append(value).append(", then ").append(then).append(")");
  }
  return changes;
}

}  // namespace calibrd
