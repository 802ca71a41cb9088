// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/cloud_tree.hpp"

#include <cmath>
#include <cstdint>
#include <nanoflann.hpp>

namespace calibrd {
namespace {

struct Cloud {
  std::vector<Eigen::Vector3f> points;
  // What nanoflann asks for:
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3>;

}  // namespace

struct CloudTree::Impl {
  explicit Impl(std::vector<Eigen::Vector3f> points) : cloud{std::move(points)} {
    if (!cloud.points.empty()) tree.emplace(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  }
  Cloud cloud;
  std::optional<Tree> tree;
};

CloudTree::CloudTree(std::vector<Eigen::Vector3f> points)
    : impl_(std::make_unique<Impl>(std::move(points))) {}
CloudTree::~CloudTree() = default;
CloudTree::CloudTree(CloudTree&&) noexcept = default;
CloudTree& CloudTree::operator=(CloudTree&&) noexcept = default;

std::optional<CloudTree::Neighbour> CloudTree::nearest(const Eigen::Vector3d& query) const {
  if (!impl_->tree) return std::nullopt;
  const Eigen::Vector3f q = query.cast<float>();
  std::uint32_t index = 0;
  float squared = 0;
  if (impl_->tree->knnSearch(q.data(), 1, &index, &squared) == 0) return std::nullopt;
  return Neighbour{impl_->cloud.points[index].cast<double>(), std::sqrt(static_cast<double>(squared))};
}

}  // namespace calibrd
