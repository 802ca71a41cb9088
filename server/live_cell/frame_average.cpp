// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_cell/frame_average.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace calibrd {
namespace {

constexpr double kSpread_m = 0.02;
constexpr int kFinest = 8;  ///< parts of the sensor's unit

/// How many parts of the unit fit into 16 bits for the largest value there is.
int finer_parts(std::span<const View> views) {
  std::uint16_t largest = 1;
  for (const auto& view : views)
    if (!view.depth.raw.empty())
      largest = std::max(largest, *std::max_element(view.depth.raw.begin(), view.depth.raw.end()));
  int parts = kFinest;
  while (parts > 1 && largest * parts > std::numeric_limits<std::uint16_t>::max()) parts /= 2;
  return parts;
}

/// Mean of the values near the median; `values` is reordered.
double central_mean(std::vector<std::uint16_t>& values, double spread) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  const double median = *middle;
  double sum = 0, count = 0;
  for (const double value : values) {
    if (std::abs(value - median) > spread) continue;
    sum += value;
    ++count;
  }
  return sum / count;
}

DepthImage average_depth(std::span<const View> views) {
  const auto& first = views.front().depth;
  const int parts = finer_parts(views);
  DepthImage average{first.width, first.height, first.scale_m / parts,
                     std::vector<std::uint16_t>(first.raw.size(), 0)};
  std::vector<std::uint16_t> values;
  for (std::size_t i = 0; i < first.raw.size(); ++i) {
    values.clear();
    for (const auto& view : views)
      if (view.depth.raw[i] != 0) values.push_back(view.depth.raw[i]);
    if (values.empty() || 2 * values.size() < views.size()) continue;
    const double mean = central_mean(values, kSpread_m / first.scale_m);
    average.raw[i] = static_cast<std::uint16_t>(std::lround(mean * parts));
  }
  return average;
}

std::optional<GreyImage> average_image(std::span<const View> views) {
  if (!std::all_of(views.begin(), views.end(), [](const View& view) { return view.image.has_value(); }))
    return std::nullopt;
  GreyImage average = *views.front().image;
  for (std::size_t i = 0; i < average.pixels.size(); ++i) {
    std::uint32_t sum = 0;
    for (const auto& view : views) sum += view.image->pixels[i];
    average.pixels[i] = static_cast<std::uint16_t>(sum / views.size());
  }
  return average;
}

}  // namespace

View average_views(std::span<const View> views) {
  if (views.size() == 1) return views.front();
  View average;
  average.depth = average_depth(views);
  average.image = average_image(views);
  average.stamp_s = views.front().stamp_s;
  average.joint_positions_rad.assign(views.front().joint_positions_rad.size(), 0);
  for (const auto& view : views)
    for (std::size_t j = 0; j < average.joint_positions_rad.size(); ++j)
      average.joint_positions_rad[j] += view.joint_positions_rad[j] / static_cast<double>(views.size());
  return average;
}

void bring_to_one_unit(std::span<View> views) {
  std::vector<double> units_m;
  double largest_m = 0;
  for (const View& view : views) {
    units_m.push_back(view.depth.scale_m);
    if (view.depth.raw.empty()) continue;
    largest_m = std::max(largest_m, view.depth.scale_m * *std::ranges::max_element(view.depth.raw));
  }
  std::ranges::sort(units_m);
  constexpr double kMost = std::numeric_limits<std::uint16_t>::max();
  const auto fits = [&](double unit_m) { return largest_m <= unit_m * kMost; };
  const auto finest = std::ranges::find_if(units_m, fits);
  if (finest == units_m.end()) return;  // there is no view
  const double unit_m = *finest;
  for (View& view : views) {
    const double parts = view.depth.scale_m / unit_m;
    for (std::uint16_t& raw : view.depth.raw) raw = static_cast<std::uint16_t>(std::lround(raw * parts));
    view.depth.scale_m = unit_m;
  }
}

}  // namespace calibrd
