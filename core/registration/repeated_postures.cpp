// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/repeated_postures.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd {
namespace {

constexpr double kSamePosture = 0.02;  // rad or m: the surfaces fall on other pixels only beyond it

bool is_same_posture(const RegistrationView& a, const RegistrationView& b) {
  return std::ranges::equal(a.reported_joints, b.reported_joints,
                            [](double p, double q) { return std::abs(p - q) < kSamePosture; });
}

}  // namespace

double views_per_posture(std::span<const RegistrationView> views) {
  std::size_t postures = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto before = views.first(v);
    postures +=
        std::ranges::none_of(before, [&](const auto& other) { return is_same_posture(views[v], other); }) ? 1
                                                                                                          : 0;
  }
  return postures > 0 ? static_cast<double>(views.size()) / static_cast<double>(postures) : 1;
}

}  // namespace calibrd
