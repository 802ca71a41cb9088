// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "bench.hpp"
#include "core/capture/ply_cloud.hpp"
#include "core/registration/cloud_registration.hpp"

namespace calibrd::bench {
namespace {

void print(const CloudRegistration& result, const std::vector<double>& milliseconds) {
  std::printf(
      "{\"median_ms\": %.3f, \"least_ms\": %.3f, \"iterations\": %d, \"converged\": %s, \"overlap\": %.3f, "
      "\"sigma_mm\": %.3f, "
      "\"T_target_source\": [",
      median(milliseconds), *std::ranges::min_element(milliseconds), result.iterations,
      result.converged ? "true" : "false", result.overlap, 1e3 * result.sigma_m);
  const Eigen::Matrix4d T = result.T_target_source.matrix();
  for (int row = 0; row < 4; ++row)
    std::printf("%s[%.12g, %.12g, %.12g, %.12g]", row > 0 ? ", " : "", T(row, 0), T(row, 1), T(row, 2),
                T(row, 3));
  std::printf("]}\n");
}

}  // namespace

int run_register(const RegisterOptions& options) {
  const auto source = read_ply(options.source);
  if (!source) return stop(source.error().message());
  const auto target = read_ply(options.target);
  if (!target) return stop(target.error().message());
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(options.threads));
  std::vector<double> milliseconds;
  CloudRegistration last;
  for (int run = 0; run < options.runs; ++run) {
    const auto begin = std::chrono::steady_clock::now();
    const auto result = register_clouds(*source, *target, {});
    const auto end = std::chrono::steady_clock::now();
    if (!result) return stop(result.error().message());
    milliseconds.push_back(std::chrono::duration<double, std::milli>(end - begin).count());
    last = *result;
  }
  print(last, milliseconds);
  return 0;
}

}  // namespace calibrd::bench
