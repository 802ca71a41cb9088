// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/view_sums.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace calibrd {

void ViewSums::merge(const ViewSums& other) {
  range.merge(other.range);
  range_tally.merge(other.range_tally);
  for (std::size_t k = 0; k < contour.size(); ++k) {
    contour[k].equations.merge(other.contour[k].equations);
    contour[k].tally.merge(other.contour[k].tally);
  }
  samples.insert(samples.end(), other.samples.begin(), other.samples.end());
}

ViewSums sum_views(std::span<const RegistrationView> views, std::span<VirtualMeasurement> predictions,
                   const CameraModel& camera, const Pose& T_base_sensor, const DepthCorrection& correction,
                   const ViewSumSettings& settings) {
  std::vector<ViewSums> per_view(views.size());
  tbb::parallel_for(std::size_t{0}, views.size(), [&](std::size_t v) {
    views[v].cell.measure(camera, T_base_sensor, predictions[v]);
    ViewSums& sums = per_view[v];
    add_range_residuals(views[v], predictions[v], camera, T_base_sensor, correction, settings.range,
                        sums.range, sums.range_tally, settings.keep_samples ? &sums.samples : nullptr);
    if (settings.contour_stride == 0) return;
    const auto contour =
        find_contour(views[v], predictions[v], camera, T_base_sensor, settings.contour_stride);
    for (std::size_t k = 0; k < kEdgeSources.size(); ++k)
      add_contour_residuals(views[v], contour, camera, T_base_sensor, settings.contour[k],
                            sums.contour[k].equations, sums.contour[k].tally);
  });
  ViewSums total;
  for (const ViewSums& sums : per_view) total.merge(sums);
  return total;
}

double robust_sigma(std::vector<float> values) {
  if (values.empty()) return 1;
  for (float& value : values) value = std::abs(value);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return std::max(1.4826 * static_cast<double>(*middle), 1e-3);
}

}  // namespace calibrd
