// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/linearization.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace calibrd {
namespace {

/// Adds the samples as they are after `delta`, and their residuals (whitened, and as they are) to the lists.
void add_moved(const std::vector<Sample>& samples, const ParameterVector& delta, double kernel,
               NormalEquations& equations, std::vector<float>& whitened, std::vector<float>* residuals) {
  for (const Sample& sample : samples) {
    Observation moved = sample.observation;
    moved.residual -= moved.jacobian.dot(delta);
    moved.robust_weight = tukey_weight(moved.residual, kernel);
    if (moved.robust_weight <= 0) continue;
    whitened.push_back(static_cast<float>(moved.residual / moved.sigma));
    if (residuals != nullptr) residuals->push_back(static_cast<float>(moved.residual));
    equations.add(moved, sample.cluster);
  }
}

}  // namespace

void ViewSums::merge(const ViewSums& other) {
  range.merge(other.range);
  range_tally.merge(other.range_tally);
  for (std::size_t k = 0; k < contour.size(); ++k) {
    contour[k].equations.merge(other.contour[k].equations);
    contour[k].tally.merge(other.contour[k].tally);
  }
}

void Linearization::Band::clear() {
  range.clear();
  range_tally = {};
  for (std::size_t k = 0; k < kEdgeSources.size(); ++k) {
    contour[k].clear();
    contour_tally[k] = {};
  }
}

void Linearization::observe(std::span<const RegistrationView> views,
                            std::span<VirtualMeasurement> predictions, const CameraModel& camera,
                            const Pose& T_base_sensor, const DepthCorrection& correction,
                            const LinearizationSettings& settings) {
  settings_ = settings;
  settings_.range.prediction_step = settings.stride;
  settings_.range.stride = 1;
  const CameraModel sparse = camera.subsampled(settings.stride);
  assert(kBandRows % settings.stride == 0);
  const int rows = kBandRows / settings.stride;
  const auto bands_per_view = static_cast<std::size_t>((sparse.height + rows - 1) / rows);
  bands_.resize(views.size() * bands_per_view);
  tbb::parallel_for(std::size_t{0}, views.size(),
                    [&](std::size_t v) { views[v].cell.measure(sparse, T_base_sensor, predictions[v]); });
  tbb::parallel_for(std::size_t{0}, bands_.size(), [&](std::size_t b) {
    Band& band = bands_[b];
    band.clear();
    const std::size_t v = b / bands_per_view;
    const int first = static_cast<int>(b % bands_per_view) * rows;
    const RowBand of_band{first, first + rows};
    observe_range(views[v], predictions[v], camera, T_base_sensor, correction, settings_.range, of_band,
                  band.range, band.range_tally);
    if (settings_.contour_stride == 0) return;
    const auto contour = find_contour(views[v], predictions[v], camera, T_base_sensor,
                                      {settings_.contour_stride, settings_.stride, of_band});
    for (std::size_t k = 0; k < kEdgeSources.size(); ++k)
      observe_contour(views[v], contour, camera, T_base_sensor, settings_.contour[k], band.contour[k],
                      band.contour_tally[k]);
  });
}

ViewSums Linearization::sums_of(const Band& band, const ParameterVector& delta) const {
  ViewSums sums;
  sums.range_tally = band.range_tally;
  sums.range_tally.whitened.clear();
  add_moved(band.range, delta, settings_.range.kernel_m, sums.range, sums.range_tally.whitened, nullptr);
  for (std::size_t k = 0; k < kEdgeSources.size(); ++k) {
    ContourSums& edges = sums.contour[k];
    edges.tally.predicted = band.contour_tally[k].predicted;
    edges.tally.found = band.contour_tally[k].found;
    add_moved(band.contour[k], delta, settings_.contour[k].kernel_px, edges.equations, edges.tally.whitened,
              &edges.tally.residuals_px);
  }
  return sums;
}

ViewSums Linearization::sums(const ParameterVector& delta) const {
  constexpr std::size_t kSoonSummed = 1500;  // sooner than a second thread wakes up
  std::vector<ViewSums> of_bands(bands_.size());
  const auto sum_band = [&](std::size_t b) { of_bands[b] = sums_of(bands_[b], delta); };
  if (range_count() < kSoonSummed)
    for (std::size_t b = 0; b < bands_.size(); ++b) sum_band(b);
  else
    tbb::parallel_for(std::size_t{0}, bands_.size(), sum_band);
  ViewSums total;
  for (const ViewSums& sums : of_bands) total.merge(sums);
  return total;
}

std::size_t Linearization::range_count() const {
  std::size_t count = 0;
  for (const Band& band : bands_) count += band.range.size();
  return count;
}

double Linearization::nearest_m() const {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Band& band : bands_)
    for (const Sample& sample : band.range) nearest_m = std::min(nearest_m, sample.depth_m);
  return std::isfinite(nearest_m) ? nearest_m : 1;
}

std::vector<Sample> Linearization::range_samples(std::size_t most) const {
  const std::size_t stride = std::max<std::size_t>(1, range_count() / most);
  std::vector<Sample> samples;
  samples.reserve(range_count() / stride + 1);
  std::size_t next = 0;  // counted over the bands, so that none is favoured
  for (const Band& band : bands_) {
    for (; next < band.range.size(); next += stride) samples.push_back(band.range[next]);
    next -= band.range.size();
  }
  return samples;
}

double robust_sigma(std::vector<float> values) {
  if (values.empty()) return 1;
  for (float& value : values) value = std::abs(value);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return std::max(1.4826 * static_cast<double>(*middle), 1e-3);
}

}  // namespace calibrd
