// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "bench.hpp"
#include "core/calibration/calibrate.hpp"
#include "core/capture/pose_json.hpp"

namespace calibrd::bench {
namespace {

/// Root mean square distance (mm) over the check points: where the pose puts them against where they should
/// be.
double check_point_rms_mm(const Input& input, const CalibrationResult& result) {
  if (!result.T_base_sensor || input.check_points.empty()) return NAN;
  double squares = 0;
  for (const auto& [p_sensor, p_base] : input.check_points)
    squares += (*result.T_base_sensor * p_sensor - p_base).squaredNorm();
  return 1e3 * std::sqrt(squares / static_cast<double>(input.check_points.size()));
}

/// What the guess is off from and the result is held against; complains when there is none.
std::optional<Pose> reference_of(const Input& input, const FineOptions& options) {
  if (!options.around.empty()) {
    auto pose = read_pose(options.around);
    if (pose) return *pose;
    std::fprintf(stderr, "calibrd-bench: %s\n", pose.error().message().c_str());
  } else if (!input.truth_T_base_sensor) {
    std::fprintf(stderr, "calibrd-bench: %s holds no truth.json; name a pose to start around with --around\n",
                 options.capture_dir.c_str());
  }
  return input.truth_T_base_sensor && options.around.empty() ? input.truth_T_base_sensor : std::nullopt;
}

}  // namespace

void print_run(const Input& input, const CalibrationResult& result, const Pose& reference) {
  const Vector6d error =
      result.T_base_sensor ? difference(reference, *result.T_base_sensor) : Vector6d::Constant(NAN);
  const double nees = error.dot(result.covariance.ldlt().solve(error));
  std::printf(
      "{\"verdict\": \"%s\", \"error_mm\": %s, \"error_mrad\": %s, \"sigma_mm\": %.4f, \"sigma_mrad\": "
      "%.4f, "
      "\"nees\": %s, \"coverage\": %.3f, \"rms_mm\": %.3f, \"offset_mm\": %.2f, \"scale\": %.5f, \"ms\": "
      "%.1f",
      name_of(result.verdict), shown(1e3 * error.tail<3>().norm(), 4).c_str(),
      shown(1e3 * error.head<3>().norm(), 4).c_str(), 1e3 * result.sigma_position_m,
      1e3 * result.sigma_rotation_rad, shown(nees, 2).c_str(), result.coverage, 1e3 * result.residual_rms_m,
      1e3 * result.depth_correction.offset_m, result.depth_correction.scale, result.time_total_ms);
  if (!input.check_points.empty())
    std::printf(", \"check_points_mm\": %s", shown(check_point_rms_mm(input, result), 3).c_str());
  std::printf(", \"reasons\": [");
  for (std::size_t i = 0; i < result.reasons.size(); ++i)
    std::printf("%s\"%s\"", i > 0 ? ", " : "", result.reasons[i].code.c_str());
  std::printf("]");
  if (result.T_base_sensor) {
    std::printf(", \"T_base_sensor\": [");
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column)
        std::printf("%s%.12g", row + column > 0 ? ", " : "", result.T_base_sensor->matrix()(row, column));
    std::printf("]");
  }
  std::printf("}\n");
}

int run_fine(const FineOptions& options) {
  const Input input = load(options.capture_dir, options.models);
  const std::optional<Pose> reference = reference_of(input, options);
  if (!reference) return 2;
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<double> milliseconds, with_verdict;
  const auto guess = [&] {
    const double size = options.vary ? share(random) : 1.0;
    return off_by(*reference, size * options.offset_mm * 1e-3,
                  size * options.offset_deg * std::numbers::pi / 180, random);
  };
  CalibrationSettings settings;
  settings.depth_only = options.depth_only;
  settings.guess_T_base_sensor = guess();
  Vector6d error = Vector6d::Constant(NAN);
  const VirtualCell cell(input.robot);
  for (int run = 0; run < options.runs; ++run) {
    if (options.vary && run > 0) settings.guess_T_base_sensor = guess();
    const CalibrationResult result = calibrate(cell, input.camera, input.views, settings);
    milliseconds.push_back(result.time_to_pose_ms);
    with_verdict.push_back(result.time_total_ms);
    if (options.vary || run == 0) print_run(input, result, *reference);
    if (result.T_base_sensor) error = difference(*reference, *result.T_base_sensor);
  }
  std::printf(
      "{\"median_ms\": %.2f, \"median_with_verdict_ms\": %.2f, \"error_mm\": %s, \"error_mrad\": %s, "
      "\"views\": %zu}\n",
      median(milliseconds), median(with_verdict), shown(1e3 * error.tail<3>().norm(), 4).c_str(),
      shown(1e3 * error.head<3>().norm(), 4).c_str(), input.views.size());
  return 0;
}

}  // namespace calibrd::bench
