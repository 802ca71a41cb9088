// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/timing/offset_search.hpp"

#include <algorithm>
#include <cmath>

namespace calibrd {

OffsetSearch::OffsetSearch(const OffsetSearchSettings& settings) : settings_(settings) {
  const auto steps = std::lround((settings.most_s - settings.least_s) / settings.step_s);
  for (long i = 0; i <= steps; ++i)
    candidates_s_.push_back(settings.least_s + static_cast<double>(i) * settings.step_s);
  reset();
}

void OffsetSearch::reset() {
  sums_.assign(candidates_s_.size(), 0);
  frames_ = 0;
}

void OffsetSearch::add(const std::vector<double>& misfits) {
  for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += misfits[i];
  ++frames_;
}

std::optional<double> OffsetSearch::found_s() const {
  if (frames_ < settings_.frames) return std::nullopt;
  const auto best = std::min_element(sums_.begin(), sums_.end());
  auto sorted = sums_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  if (*best > (1 - settings_.least_gain) * *middle) return std::nullopt;
  return candidates_s_[static_cast<std::size_t>(best - sums_.begin())];
}

}  // namespace calibrd
