// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/render/texture.hpp"

#include <cmath>

namespace calibrd::sim {
namespace {

constexpr float kCells_per_m = 25.0F;

float lattice(int x, int y, int z, std::uint32_t seed) {
  std::uint32_t h = seed * 0x9e3779b1U + static_cast<std::uint32_t>(x) * 0x85ebca77U +
                    static_cast<std::uint32_t>(y) * 0xc2b2ae3dU + static_cast<std::uint32_t>(z) * 0x27d4eb2fU;
  h = (h ^ (h >> 15)) * 0x2c1b3c6dU;
  h = (h ^ (h >> 12)) * 0x297a2d39U;
  h ^= h >> 15;
  return static_cast<float>(h >> 8) * (2.0F / 16777216.0F) - 1.0F;
}

float smooth(float t) { return t * t * (3 - 2 * t); }
float mix(float a, float b, float t) { return a + (b - a) * t; }

}  // namespace

float mottling(const Eigen::Vector3f& point_body, std::uint32_t seed) {
  const Eigen::Vector3f p = point_body * kCells_per_m;
  const float fx = std::floor(p.x()), fy = std::floor(p.y()), fz = std::floor(p.z());
  const int x = static_cast<int>(fx), y = static_cast<int>(fy), z = static_cast<int>(fz);
  const float tx = smooth(p.x() - fx), ty = smooth(p.y() - fy), tz = smooth(p.z() - fz);
  const auto along_x = [&](int dy, int dz) {
    return mix(lattice(x, y + dy, z + dz, seed), lattice(x + 1, y + dy, z + dz, seed), tx);
  };
  return mix(mix(along_x(0, 0), along_x(1, 0), ty), mix(along_x(0, 1), along_x(1, 1), ty), tz);
}

}  // namespace calibrd::sim
