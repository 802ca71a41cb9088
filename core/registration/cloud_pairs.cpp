// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/cloud_pairs.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace calibrd {
namespace {

constexpr std::size_t kChunk = 256;  // pairs one thread takes at a time; the sums' order depends on it alone

// One product (J, r, 1)(J, r, 1)ᵀ holds all sums of a pair; 8 floats fill two SSE registers.
using Row = Eigen::Matrix<float, 8, 1>;
using Products = Eigen::Matrix<float, 8, 8>;

}  // namespace

CloudPairs::CloudPairs(const SurfaceCloud& source, const SurfaceCloud& target)
    : source_(source), target_(target), pairs_(source.size()), partners_(source.size(), -1) {}

CloudPairs::Pair CloudPairs::join(std::size_t i, std::size_t partner, const Eigen::Vector3f& point,
                                  const Eigen::Matrix3f& R, float lateral_m) const {
  const Eigen::Vector3f ours = R * source_.normals[i], &theirs = target_.normals[partner];
  const Eigen::Vector3f sum = ours.dot(theirs) < 0 ? Eigen::Vector3f(ours - theirs) : ours + theirs;
  const float length = sum.norm();
  if (!(length > 0)) return {};  // neither has a normal; where one is missing, the other serves
  const Eigen::Vector3f normal = sum / length;
  const Eigen::Vector3f to_partner = target_.grid.points()[partner] - point;
  const float distance = normal.dot(to_partner);
  if (to_partner.squaredNorm() - distance * distance > lateral_m * lateral_m) return {};
  return {point, normal, distance,
          (source_.normal_variance[i] + target_.normal_variance[partner]) / (length * length)};
}

void CloudPairs::match(const Pose& T_target_source, float reach_m, float lateral_m) {
  const Eigen::Matrix3f R = T_target_source.linear().cast<float>();
  const Eigen::Vector3f t = T_target_source.translation().cast<float>();
  const tbb::blocked_range<std::size_t> all(0, source_.size(), kChunk);
  tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& part) {
    for (std::size_t i = part.begin(); i < part.end(); ++i) {
      const Eigen::Vector3f point = R * source_.grid.points()[i] + t;
      partners_[i] = target_.grid.nearest(point, reach_m, partners_[i]).index;
      pairs_[i] =
          partners_[i] < 0 ? Pair{} : join(i, static_cast<std::size_t>(partners_[i]), point, R, lateral_m);
    }
  });
}

float CloudPairs::sigma_m() {
  constexpr std::size_t kEnough = 1500;  // more would not make the median better than its use asks for
  const std::size_t step = pairs_.size() / kEnough + 1;
  distances_m_.clear();
  for (std::size_t i = 0; i < pairs_.size(); i += step)
    if (pairs_[i].exists()) distances_m_.push_back(std::abs(pairs_[i].distance));
  if (distances_m_.empty()) return 0;
  const auto middle = distances_m_.begin() + static_cast<std::ptrdiff_t>(distances_m_.size() / 2);
  std::nth_element(distances_m_.begin(), middle, distances_m_.end());
  return 1.4826F * *middle;
}

double CloudPairs::overlap(float kernel_m) const {
  const auto agrees = [&](const Pair& pair) { return pair.exists() && std::abs(pair.distance) < kernel_m; };
  const auto agreeing = static_cast<double>(std::ranges::count_if(pairs_, agrees));
  return pairs_.empty() ? 0 : agreeing / static_cast<double>(pairs_.size());
}

PairSums CloudPairs::sums(float kernel_m) const {
  struct Part {
    Products products = Products::Zero();
    float false_information = 0;
  };
  std::vector<Part> parts((pairs_.size() + kChunk - 1) / kChunk);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t p) {
    Part part;
    const std::size_t end = std::min(pairs_.size(), (p + 1) * kChunk);
    for (std::size_t i = p * kChunk; i < end; ++i) {
      const Pair& pair = pairs_[i];
      const float off = pair.distance / kernel_m, inside = 1 - off * off;
      if (inside <= 0 || !pair.exists()) continue;
      const float weight = inside * inside;
      Row row;
      row.head<3>() = pair.point.cross(pair.normal);
      row.segment<3>(3) = pair.normal;
      row[6] = pair.distance;
      row[7] = 1;
      part.products.noalias() += (weight * row) * row.transpose();
      part.false_information += weight * pair.normal_variance;
    }
    parts[p] = part;
  });
  Eigen::Matrix<double, 8, 8> total = Eigen::Matrix<double, 8, 8>::Zero();
  PairSums sums;
  for (const Part& part : parts) {
    total += part.products.cast<double>();
    sums.false_information += part.false_information;
  }
  sums.information = total.topLeftCorner<6, 6>();
  sums.gradient = total.block<6, 1>(0, 6);
  sums.weight = total(7, 7);
  return sums;
}

}  // namespace calibrd
