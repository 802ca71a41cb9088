// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/global/distance_field.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd {
namespace {

constexpr float kFar = 1e12F;  // squared, in voxels

/// Squared distance transform of one line in place: the lower envelope of parabolas.
class LineTransform {
 public:
  explicit LineTransform(std::size_t longest) : value_(longest), apex_(longest), from_(longest + 1) {}

  void run(float* line, int count, std::ptrdiff_t stride) {
    for (int i = 0; i < count; ++i) value_[static_cast<std::size_t>(i)] = line[i * stride];
    int last = 0;
    apex_[0] = 0;
    from_[0] = -kFar;
    from_[1] = kFar;
    for (int q = 1; q < count; ++q) {
      float start = crossing(q, apex_[static_cast<std::size_t>(last)]);
      while (start <= from_[static_cast<std::size_t>(last)]) {
        --last;
        start = crossing(q, apex_[static_cast<std::size_t>(last)]);
      }
      ++last;
      apex_[static_cast<std::size_t>(last)] = q;
      from_[static_cast<std::size_t>(last)] = start;
      from_[static_cast<std::size_t>(last) + 1] = kFar;
    }
    int k = 0;
    for (int q = 0; q < count; ++q) {
      while (from_[static_cast<std::size_t>(k) + 1] < static_cast<float>(q)) ++k;
      const int p = apex_[static_cast<std::size_t>(k)];
      line[q * stride] = static_cast<float>((q - p) * (q - p)) + value_[static_cast<std::size_t>(p)];
    }
  }

 private:
  /// Where the parabola of `q` falls below that of `p` (p < q).
  float crossing(int q, int p) const {
    return ((value_[static_cast<std::size_t>(q)] + static_cast<float>(q * q)) -
            (value_[static_cast<std::size_t>(p)] + static_cast<float>(p * p))) /
           static_cast<float>(2 * q - 2 * p);
  }
  std::vector<float> value_;
  std::vector<int> apex_;
  std::vector<float> from_;
};

}  // namespace

DistanceField::DistanceField(std::span<const Eigen::Vector3f> points, float voxel_m, float margin_m)
    : voxel_m_(voxel_m) {
  Eigen::AlignedBox3f bounds;
  for (const auto& p : points) bounds.extend(p);
  const Eigen::Vector3f low = bounds.min().array() - margin_m;
  const Eigen::Vector3f extent = (bounds.max().array() + margin_m - low.array()) / voxel_m;
  for (int axis = 0; axis < 3; ++axis)
    size_[static_cast<std::size_t>(axis)] = static_cast<int>(std::ceil(extent[axis])) + 2;
  const Eigen::Vector3f nodes(static_cast<float>(size_[0] - 1), static_cast<float>(size_[1] - 1),
                              static_cast<float>(size_[2] - 1));
  box_ = Eigen::AlignedBox3f(low, low + voxel_m * nodes);
  mark(points);
  for (int axis = 0; axis < 3; ++axis) transform_along(axis);
  for (float& d : distance_) d = voxel_m_ * std::sqrt(d);
}

void DistanceField::mark(std::span<const Eigen::Vector3f> points) {
  distance_.assign(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
                       static_cast<std::size_t>(size_[2]),
                   kFar);
  for (const auto& p : points) {
    const Eigen::Vector3i node = ((p - box_.min()) / voxel_m_).array().round().cast<int>();
    distance_[static_cast<std::size_t>((node.z() * size_[1] + node.y()) * size_[0] + node.x())] = 0;
  }
}

void DistanceField::transform_along(int axis) {
  const std::array<std::ptrdiff_t, 3> step{1, size_[0], std::ptrdiff_t{size_[0]} * size_[1]};
  const auto a = static_cast<std::size_t>(axis), b = (a + 1) % 3, c = (a + 2) % 3;
  LineTransform line(static_cast<std::size_t>(size_[a]));
  for (int j = 0; j < size_[c]; ++j)
    for (int i = 0; i < size_[b]; ++i)
      line.run(distance_.data() + i * step[b] + j * step[c], size_[a], step[a]);
}

DistanceField::Value DistanceField::at(const Eigen::Vector3f& p) const {
  const Eigen::Vector3f inside = p.cwiseMax(box_.min()).cwiseMin(box_.max());
  const Eigen::Vector3f g = (inside - box_.min()) / voxel_m_;
  const int x = std::min(static_cast<int>(g.x()), size_[0] - 2),
            y = std::min(static_cast<int>(g.y()), size_[1] - 2),
            z = std::min(static_cast<int>(g.z()), size_[2] - 2);
  const float u = g.x() - static_cast<float>(x), v = g.y() - static_cast<float>(y),
              w = g.z() - static_cast<float>(z);
  const auto sx = static_cast<std::ptrdiff_t>(size_[0]);
  const auto sxy = sx * size_[1];
  const float* d = distance_.data() + z * sxy + y * sx + x;
  const float x00 = d[1] - d[0], x10 = d[sx + 1] - d[sx], x01 = d[sxy + 1] - d[sxy],
              x11 = d[sxy + sx + 1] - d[sxy + sx];
  const float d00 = d[0] + u * x00, d10 = d[sx] + u * x10, d01 = d[sxy] + u * x01,
              d11 = d[sxy + sx] + u * x11;
  const float d0 = d00 + v * (d10 - d00), d1 = d01 + v * (d11 - d01);
  Value value;
  value.distance_m = d0 + w * (d1 - d0);
  value.gradient.x() = ((1 - w) * ((1 - v) * x00 + v * x10) + w * ((1 - v) * x01 + v * x11)) / voxel_m_;
  value.gradient.y() = ((1 - w) * (d10 - d00) + w * (d11 - d01)) / voxel_m_;
  value.gradient.z() = (d1 - d0) / voxel_m_;
  const Eigen::Vector3f beyond = p - inside;
  if (const float way = beyond.norm(); way > 0) {
    value.distance_m += way;
    // Along an axis on which the place lies outside, the grid's value stays and the way grows.
    value.gradient = (beyond.array() == 0).select(value.gradient, beyond / way);
  }
  return value;
}

}  // namespace calibrd
