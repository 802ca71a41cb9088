// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nanoflann.hpp>
#include <optional>
#include <vector>

namespace calibrd {

/// A point cloud and its search tree. Immutable once made. Included by .cpp files alone: it shows nanoflann.
class CloudTree {
 public:
  struct Neighbour {
    Eigen::Vector3d point;
    double distance_m;
  };

  explicit CloudTree(std::vector<Eigen::Vector3f> points)
      : cloud_(std::make_unique<Cloud>(Cloud{std::move(points)})) {
    if (!cloud_->points.empty())
      tree_ = std::make_unique<Tree>(3, *cloud_, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  }

  std::optional<Neighbour> nearest(const Eigen::Vector3d& query) const {
    if (!tree_) return std::nullopt;
    const Eigen::Vector3f q = query.cast<float>();
    std::uint32_t index = 0;
    float squared = 0;
    if (tree_->knnSearch(q.data(), 1, &index, &squared) == 0) return std::nullopt;
    return Neighbour{cloud_->points[index].cast<double>(), std::sqrt(static_cast<double>(squared))};
  }

 private:
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
  std::unique_ptr<Cloud> cloud_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace calibrd
