// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

namespace calibrd {

struct OffsetSearchSettings {
  double least_s = -0.15, most_s = 0.25;  ///< what offsets are thought of
  double step_s = 0.02;
  std::size_t frames = 8;   ///< before anything is said
  double least_gain = 0.2;  ///< the best fits better than the typical one by this share of its misfit
};

/// Finds roughly which offset makes frames of a moving robot fit, from their misfit at every candidate.
class OffsetSearch {
 public:
  explicit OffsetSearch(const OffsetSearchSettings& settings = {});
  void reset();

  const std::vector<double>& candidates_s() const { return candidates_s_; }
  /// One value for each candidate.
  void add(const std::vector<double>& misfits);
  /// Nothing while the frames so far do not tell.
  std::optional<double> found_s() const;

 private:
  OffsetSearchSettings settings_;
  std::vector<double> candidates_s_, sums_;
  std::size_t frames_ = 0;
};

}  // namespace calibrd
