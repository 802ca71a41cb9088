// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sim/world/commanded_motion.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd::sim {
namespace {

constexpr double kS_per_ns = 1e-9;

Joints between(const CommandedMotion::Point& a, const CommandedMotion::Point& b, std::int64_t at_ns) {
  const double h = static_cast<double>(b.at_ns - a.at_ns) * kS_per_ns;
  const double u = static_cast<double>(at_ns - a.at_ns) * kS_per_ns / h;
  Joints q{};
  for (std::size_t j = 0; j < q.size(); ++j) {
    const double way = b.positions[j] - a.positions[j];
    const double va = h * a.velocities[j], vb = h * b.velocities[j];
    q[j] = a.positions[j] + u * (va + u * (3 * way - 2 * va - vb + u * (va + vb - 2 * way)));
  }
  return q;
}

}  // namespace

Joints CommandedMotion::at(std::int64_t now_ns) const {
  const std::int64_t at_ns = std::min(now_ns, stop_ns);
  if (at_ns <= points[0].at_ns) return points[0].positions;
  for (std::size_t i = 1; i < static_cast<std::size_t>(count); ++i)
    if (at_ns < points[i].at_ns) return between(points[i - 1], points[i], at_ns);
  return points[static_cast<std::size_t>(count - 1)].positions;
}

std::int64_t CommandedMotion::end_ns() const {
  return count == 0 ? 0 : std::min(stop_ns, points[static_cast<std::size_t>(count - 1)].at_ns);
}

void CommandedMotion::begin(const Joints& here, std::int64_t now_ns) {
  *this = {};
  push({now_ns, here, {}});
}

void CommandedMotion::add(double after_s, const Joints& positions, const Joints& velocities,
                          std::int64_t now_ns) {
  const Point last = points[static_cast<std::size_t>(count - 1)];
  const std::int64_t from_ns = std::max(last.at_ns, now_ns);
  if (last.at_ns < now_ns) push({now_ns, last.positions, {}});
  push({from_ns + std::llround(after_s * 1e9), positions, velocities});
}

void CommandedMotion::stop(std::int64_t now_ns) { stop_ns = std::min(stop_ns, now_ns); }

void CommandedMotion::push(const Point& point) {
  if (count == kMaxPoints) {
    std::copy(points.begin() + 1, points.end(), points.begin());
    --count;
  }
  points[static_cast<std::size_t>(count++)] = point;
}

}  // namespace calibrd::sim
