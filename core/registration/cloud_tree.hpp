// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

namespace calibrd {

/// A point cloud and its search tree. Immutable once made: safe to search from any thread.
class CloudTree {
 public:
  struct Neighbour {
    Eigen::Vector3d point;
    double distance_m;
  };

  explicit CloudTree(std::vector<Eigen::Vector3f> points);
  ~CloudTree();
  CloudTree(CloudTree&&) noexcept;
  CloudTree& operator=(CloudTree&&) noexcept;

  /// Nothing when the cloud is empty.
  std::optional<Neighbour> nearest(const Eigen::Vector3d& query) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace calibrd
