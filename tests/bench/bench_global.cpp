// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>

#include "bench.hpp"
#include "core/calibration/calibrate.hpp"
#include "core/global/find_start.hpp"

namespace calibrd::bench {
namespace {

/// The search alone: its hypotheses, best first, against the truth where that is known.
void print_starts(const Input& input) {
  const VirtualCell cell(input.robot);
  const auto views = prepare_views(cell, input.camera, input.views, {});
  const auto begin = std::chrono::steady_clock::now();
  const auto starts = find_starts(views, robot_candidates(views, input.camera), input.camera, {});
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
  std::printf("{\"search_ms\": %.1f, \"hypotheses\": [", took.count());
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const Vector6d error = input.truth_T_base_sensor
                               ? difference(*input.truth_T_base_sensor, starts[i].T_base_sensor)
                               : Vector6d::Constant(NAN).eval();
    std::printf("%s{\"score\": %.3f, \"error_mm\": %s, \"error_mrad\": %s}", i > 0 ? ", " : "",
                starts[i].score.value(), shown(1e3 * error.tail<3>().norm(), 1).c_str(),
                shown(1e3 * error.head<3>().norm(), 1).c_str());
  }
  std::printf("]}\n");
}

}  // namespace

int run_global(const GlobalOptions& options) {
  const Input input = load(options.capture_dir, options.models);
  if (options.starts) print_starts(input);
  CalibrationSettings settings;
  settings.depth_only = options.depth_only;
  std::vector<double> milliseconds;
  CalibrationResult result;
  const VirtualCell cell(input.robot);
  for (int run = 0; run < options.runs; ++run) {
    result = calibrate(cell, input.camera, input.views, settings);
    milliseconds.push_back(result.time_total_ms);
  }
  const Pose reference = input.truth_T_base_sensor.value_or(result.T_base_sensor.value_or(Pose::Identity()));
  print_run(input, result, reference);
  std::printf("{\"median_ms\": %.2f, \"views\": %zu}\n", median(milliseconds), input.views.size());
  return 0;
}

}  // namespace calibrd::bench
